// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

namespace multicam_egomotion {

/// Square periodic grey texture with mipmaps: random leaves of all sizes that hide each other ("dead leaves"; Lee,
/// Mumford, Huang, IJCV 2001), so that there are sharp corners whatever the distance.
class Texture {
 public:
  /// `size`: texels a side, a power of two.
  Texture(int size, std::uint64_t seed);

  /// Two neighbouring mipmaps and the weight of the coarser one.
  struct Level {
    int index;
    float blend;
  };
  /// Level that smooths over `footprint` texels of the finest level.
  Level levelFor(float footprint) const;

  /// Grey value (0 to 255) at (u, v) [texels of the finest level]; trilinear.
  float sample(float u, float v, const Level& level) const {
    const float fine = bilinear(mipmaps_[level.index], u, v);
    if (level.blend == 0.0f) return fine;
    return fine + level.blend * (bilinear(mipmaps_[level.index + 1], u, v) - fine);
  }

 private:
  struct Mipmap {
    std::vector<std::uint8_t> texels;
    int size;
    float scale;  // texels of this level to one of the finest
  };

  // Texel centres of level l lie at (i + 0.5) 2^l. Floor by hand: the library's is slow without SSE 4.1.
  static float bilinear(const Mipmap& level, float u, float v) {
    const float x = u * level.scale - 0.5f, y = v * level.scale - 0.5f;
    int ix = static_cast<int>(x), iy = static_cast<int>(y);
    ix -= x < static_cast<float>(ix);
    iy -= y < static_cast<float>(iy);
    const float fx = x - static_cast<float>(ix), fy = y - static_cast<float>(iy);
    const int mask = level.size - 1, x0 = ix & mask, x1 = (ix + 1) & mask;
    const std::uint8_t* row0 = level.texels.data() + (iy & mask) * level.size;
    const std::uint8_t* row1 = level.texels.data() + ((iy + 1) & mask) * level.size;
    const float top = row0[x0] + fx * static_cast<float>(row0[x1] - row0[x0]);
    const float bottom = row1[x0] + fx * static_cast<float>(row1[x1] - row1[x0]);
    return top + fy * (bottom - top);
  }

  std::vector<Mipmap> mipmaps_;
};

}  // namespace multicam_egomotion
