// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "multicam_egomotion/geometry/camera_model.h"
#include "simulator/scene.h"

namespace multicam_egomotion {

/// Ray-casts a scene through the full model of one camera. Textures are smoothed over the pixel, edges are
/// supersampled. Pixels that the model cannot see are black.
class Renderer {
 public:
  explicit Renderer(const CameraModel& model);

  /// Grey image without noise, CV_32FC1 (0 to 255); the result does not depend on `threads`.
  cv::Mat render(const Scene& scene, const Eigen::Isometry3d& T_world_cam, int threads) const;

 private:
  static constexpr int kTile = 32;
  struct PixelRay {
    Eigen::Vector3f bearing, d_u, d_v;  // optical frame; the bearing is 0 where the model sees nothing
  };
  struct Tile {
    Eigen::Vector3d axis;  // optical frame
    double half_angle;
  };
  struct Shot;

  void castTileRow(const Scene& scene, int tile_y, Shot* shot) const;
  void shadeRow(const Scene& scene, int y, Shot* shot) const;
  float supersample(const Scene& scene, const PixelRay& ray, const Shot& shot, const std::vector<int>& boxes) const;

  int width_, height_, tiles_x_, tiles_y_;
  std::vector<PixelRay> rays_;
  std::vector<Tile> tiles_;
};

/// Rounds to CV_8UC1 with seeded Gaussian noise of `sigma` grey levels.
cv::Mat addImageNoise(const cv::Mat& image, double sigma, std::uint64_t seed, std::uint64_t stream);

}  // namespace multicam_egomotion
