// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace multicam_egomotion {

/// Random numbers that are the same for a seed on any platform: SplitMix64 (Steele, Lea and Flood 2014).
class RandomIndex {
 public:
  explicit RandomIndex(std::uint64_t seed) : state_(seed) {}

  /// In [0, bound); bound is at least 1.
  std::uint32_t below(std::uint32_t bound) {
    std::uint64_t z = (state_ += 0x9e3779b97f4a7c15ULL);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
    z ^= z >> 31;
    return static_cast<std::uint32_t>(((z >> 32) * bound) >> 32);
  }

 private:
  std::uint64_t state_;
};

}  // namespace multicam_egomotion
