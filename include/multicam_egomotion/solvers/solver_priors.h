// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>

namespace multicam_egomotion {

/// Vertical direction in both body frames as rotations into gravity-aligned frames with z up: R_aligned_body * up = z.
/// The yaw of the aligned frames is free. (The paper's R_imu1, R_imu2 align with y; z up takes its place here.)
struct VerticalPrior {
  Eigen::Matrix3d R_aligned_body1;
  Eigen::Matrix3d R_aligned_body2;
};

/// Direction of the rotation axis: the same vector in the body frames at t1 and t2; its length and sign do not matter.
struct AxisPrior {
  Eigen::Vector3d axis;
};

/// Rotation angle; the axis is free, so its sign and whole turns do not matter.
struct AnglePrior {
  double angle;  ///< [rad]
};

/// A rotation that turns `direction` (not zero) into z; its yaw is arbitrary but depends on `direction` alone.
inline Eigen::Matrix3d rotationToZ(const Eigen::Vector3d& direction) {
  const Eigen::Vector3d z = direction / direction.norm();
  const double sign = std::copysign(1.0, z.z());
  const double a = -1.0 / (sign + z.z());
  const double b = z.x() * z.y() * a;
  Eigen::Matrix3d R;
  R << 1.0 + sign * z.x() * z.x() * a, sign * b, -sign * z.x(),  //
      b, sign + z.y() * z.y() * a, -z.y(),                       //
      z.x(), z.y(), z.z();
  return R;
}

/// The vertical prior from the up directions (minus gravity; not zero) in the body frames at t1 and t2.
inline VerticalPrior verticalPriorFromUp(const Eigen::Vector3d& up_body1, const Eigen::Vector3d& up_body2) {
  return {rotationToZ(up_body1), rotationToZ(up_body2)};
}

}  // namespace multicam_egomotion
