// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "multicam_egomotion/geometry/camera_model.h"

namespace multicam_egomotion {

/// Second order [1/px] of a map of the image about (0, 0): what multiplies (x^2, x y, y^2). Second differences over
/// +- `step_px`.
template <typename Map>
Eigen::Matrix<double, 2, 3> secondOrder(const Map& map, double step_px) {
  const double h = step_px;
  const Eigen::Vector2d twice_centre = 2.0 * map(0.0, 0.0);
  Eigen::Matrix<double, 2, 3> order;
  order.col(0) = map(h, 0.0) + map(-h, 0.0) - twice_centre;
  order.col(2) = map(0.0, h) + map(0.0, -h) - twice_centre;
  order.col(1) = map(h, h) + map(-h, -h) - twice_centre - order.col(0) - order.col(2);
  return order / (2.0 * h * h);
}

/// Second order of a camera's image. Between two places of an image a small patch of the scene does not change by an
/// affine map alone: the lens and the flat image bend it, near the edge of a wide field of view by some hundredths of a
/// pixel on average over the patch.
class ImageCurvature {
 public:
  /// `step_px`: of the second differences, some third of a patch [px].
  ImageCurvature(const CameraModel& model, double step_px);

  /// In the plane that touches the viewing sphere at `pixel`, scaled as the image is there, what the image shows at
  /// pixel + (x, y) lies at (x, y) + curvature * (x^2, x y, y^2) [1/px]. Zero where the model cannot be inverted.
  Eigen::Matrix<double, 2, 3> at(const Eigen::Vector2d& pixel) const;

 private:
  int columns_, rows_;
  std::vector<Eigen::Matrix<double, 2, 3>> nodes_;  ///< row by row
};

/// Curvature of a patch in the image: `of_patch` as it was where the patch was cut, `of_image` as it is where it is
/// now, `linear` the linear part of the map between. The scene's own part is taken for affine in the touching planes.
Eigen::Matrix<double, 2, 3> patchCurvature(const Eigen::Matrix<double, 2, 3>& of_patch,
                                           const Eigen::Matrix<double, 2, 3>& of_image, const Eigen::Matrix2d& linear);

}  // namespace multicam_egomotion
