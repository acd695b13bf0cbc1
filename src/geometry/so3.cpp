// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "multicam_egomotion/geometry/so3.h"

#include <cmath>

namespace multicam_egomotion {
namespace {

// (1 - cos a) / a^2 without cancellation.
double oneMinusCosOverSquare(double a) {
  if (a < 1e-8) return 0.5;
  const double s = std::sin(0.5 * a) / a;
  return 2.0 * s * s;
}

// (a - sin a) / a^3; the series where the difference would cancel.
double angleMinusSinOverCube(double a) {
  const double a2 = a * a;
  if (a < 0.3) return 1.0 / 6 - a2 * (1.0 / 120 - a2 * (1.0 / 5040 - a2 * (1.0 / 362880 - a2 / 39916800)));
  return (a - std::sin(a)) / (a2 * a);
}

}  // namespace

Eigen::Matrix3d expSO3(const Eigen::Vector3d& rotation_vector) {
  const double angle = rotation_vector.norm();
  const double sinc = angle < 1e-8 ? 1.0 : std::sin(angle) / angle;
  const Eigen::Matrix3d k = skew(rotation_vector);
  return Eigen::Matrix3d::Identity() + sinc * k + oneMinusCosOverSquare(angle) * (k * k);
}

Eigen::Vector3d logSO3(const Eigen::Matrix3d& R) {
  // The quaternion keeps full precision at both ends: its vector part near 0, its scalar part near pi.
  Eigen::Quaterniond q(R);
  if (q.w() < 0) q.coeffs() = -q.coeffs();
  const double n = q.vec().norm();
  if (n < 1e-12) return 2.0 * q.vec();
  return (2.0 * std::atan2(n, q.w()) / n) * q.vec();
}

Eigen::Matrix3d rightJacobianSO3(const Eigen::Vector3d& rotation_vector) {
  const double angle = rotation_vector.norm();
  const Eigen::Matrix3d k = skew(rotation_vector);
  return Eigen::Matrix3d::Identity() - oneMinusCosOverSquare(angle) * k + angleMinusSinOverCube(angle) * (k * k);
}

Eigen::Matrix3d inverseRightJacobianSO3(const Eigen::Vector3d& rotation_vector) {
  const double angle = rotation_vector.norm();
  const double a2 = angle * angle;
  const double half = 0.5 * angle;
  const double c = angle < 0.1 ? 1.0 / 12 + a2 * (1.0 / 720 + a2 * (1.0 / 30240 + a2 / 1209600))
                               : (1.0 - half * std::cos(half) / std::sin(half)) / a2;
  const Eigen::Matrix3d k = skew(rotation_vector);
  return Eigen::Matrix3d::Identity() + 0.5 * k + c * (k * k);
}

}  // namespace multicam_egomotion
