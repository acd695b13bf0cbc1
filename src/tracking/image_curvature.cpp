// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "multicam_egomotion/tracking/image_curvature.h"

#include <algorithm>
#include <cstddef>

#include "multicam_egomotion/tracking/image_point.h"

namespace multicam_egomotion {
namespace {

using Curvature = Eigen::Matrix<double, 2, 3>;

constexpr int kSpacing = 16;  // of the nodes [px]

Curvature curvatureAt(const CameraModel& model, const Eigen::Vector2d& pixel, double step) {
  ImagePoint point;
  if (!makeImagePoint(model, pixel, &point)) return Curvature::Zero();
  const Eigen::Matrix<double, 2, 3> to_pixel = bearingToPixel(point);
  bool seen = true;
  const auto inPlane = [&](double x, double y) {
    Eigen::Vector3d bearing = point.bearing;
    seen = seen && model.unproject(pixel + Eigen::Vector2d(x, y), &bearing);
    return Eigen::Vector2d(to_pixel * bearing / point.bearing.dot(bearing));
  };
  const Curvature curvature = secondOrder(inPlane, step);
  return seen ? curvature : Curvature::Zero();
}

}  // namespace

ImageCurvature::ImageCurvature(const CameraModel& model, double step_px)
    : columns_(model.width() / kSpacing + 2), rows_(model.height() / kSpacing + 2) {
  nodes_.reserve(static_cast<std::size_t>(columns_) * rows_);
  for (int row = 0; row < rows_; ++row) {
    for (int column = 0; column < columns_; ++column) {
      nodes_.push_back(curvatureAt(model, {kSpacing * column, kSpacing * row}, step_px));
    }
  }
}

Curvature ImageCurvature::at(const Eigen::Vector2d& pixel) const {
  const Eigen::Vector2d place = pixel / kSpacing;
  const int column = std::clamp(static_cast<int>(place.x()), 0, columns_ - 2);
  const int row = std::clamp(static_cast<int>(place.y()), 0, rows_ - 2);
  const double x = std::clamp(place.x() - column, 0.0, 1.0), y = std::clamp(place.y() - row, 0.0, 1.0);
  const Curvature* upper = &nodes_[row * columns_ + column];
  const Curvature* lower = upper + columns_;
  return (1.0 - y) * ((1.0 - x) * upper[0] + x * upper[1]) + y * ((1.0 - x) * lower[0] + x * lower[1]);
}

Curvature patchCurvature(const Curvature& of_patch, const Curvature& of_image, const Eigen::Matrix2d& linear) {
  const double a = linear(0, 0), b = linear(0, 1), c = linear(1, 0), d = linear(1, 1);
  Eigen::Matrix3d squares;  // from (x^2, x y, y^2) to those of linear * (x, y)
  squares << a * a, 2.0 * a * b, b * b, a * c, a * d + b * c, b * d, c * c, 2.0 * c * d, d * d;
  return linear * of_patch - of_image * squares;
}

}  // namespace multicam_egomotion
