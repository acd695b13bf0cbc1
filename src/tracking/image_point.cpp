// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "multicam_egomotion/tracking/image_point.h"

#include <Eigen/LU>
#include <cmath>

namespace multicam_egomotion {

bool makeImagePoint(const CameraModel& model, const Eigen::Vector2d& pixel, ImagePoint* point) {
  point->pixel = pixel;
  return model.unproject(pixel, &point->bearing, &point->bearing_derivative);
}

Eigen::Matrix<double, 2, 3> bearingToPixel(const ImagePoint& point) {
  const auto& J = point.bearing_derivative;
  return (J.transpose() * J).inverse() * J.transpose();
}

double epipolarError(const ImagePoint& a, const ImagePoint& b, const Eigen::Isometry3d& T_b_a) {
  const Eigen::Vector3d t = T_b_a.translation();
  const Eigen::Vector3d turned_a = T_b_a.linear() * a.bearing;
  const Eigen::Vector3d normal_b = t.cross(turned_a);
  const Eigen::Vector3d across_b = b.bearing.cross(t);
  const Eigen::Vector3d normal_a = T_b_a.linear().transpose() * across_b;
  const double squared_gradient = (b.bearing_derivative.transpose() * normal_b).squaredNorm() +
                                  (a.bearing_derivative.transpose() * normal_a).squaredNorm();
  const double to_pixel = squared_gradient > 0 ? 1.0 / std::sqrt(squared_gradient) : 0.0;
  return to_pixel * b.bearing.dot(normal_b);
}

double inverseDistance(const ImagePoint& a, const ImagePoint& b, const Eigen::Isometry3d& T_b_a) {
  const Eigen::Vector3d across = b.bearing.cross(T_b_a.translation());
  const double squared_norm = across.squaredNorm();
  return squared_norm > 0 ? -across.dot(b.bearing.cross(T_b_a.linear() * a.bearing)) / squared_norm : 0.0;
}

}  // namespace multicam_egomotion
