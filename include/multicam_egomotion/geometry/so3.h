// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace multicam_egomotion {

/// [v]x, the matrix of the cross product v × ·.
inline Eigen::Matrix3d skew(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

/// Rotation matrix of a rotation vector [rad].
Eigen::Matrix3d expSO3(const Eigen::Vector3d& rotation_vector);

/// Rotation vector [rad] of a rotation matrix, norm in [0, pi]; exact to machine precision near 0 and near pi.
Eigen::Vector3d logSO3(const Eigen::Matrix3d& R);

/// Right Jacobian: Exp(v + d) = Exp(v) Exp(Jr(v) d) to first order.
Eigen::Matrix3d rightJacobianSO3(const Eigen::Vector3d& rotation_vector);

/// Inverse of the right Jacobian: Log(Exp(v) Exp(d)) = v + Jr^-1(v) d to first order.
Eigen::Matrix3d inverseRightJacobianSO3(const Eigen::Vector3d& rotation_vector);

}  // namespace multicam_egomotion
