// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "multicam_egomotion/imu/imu_mounting.h"

#include <cmath>

#include "multicam_egomotion/geometry/so3.h"

namespace multicam_egomotion {

Eigen::Vector3d shortestArc(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  const Eigen::Vector3d cross = from.cross(to);
  const double angle = std::atan2(cross.norm(), from.dot(to));
  if (cross.norm() > 1e-12 * from.norm() * to.norm()) {
    return angle * cross.normalized();
  }
  return angle * from.unitOrthogonal();  // 0, or half a turn about any axis across
}

Eigen::Matrix3d levelAttitude(const Eigen::Vector3d& up_in_body) {
  const Eigen::Vector3d up = up_in_body.normalized();
  static const double kVertical = std::cos(30.0 * M_PI / 180.0);
  if (std::abs(up.x()) > kVertical) {
    return expSO3(shortestArc(up, Eigen::Vector3d::UnitZ()));
  }
  Eigen::Matrix3d R_odom_body;  // rows: odom axes in the body
  R_odom_body.row(0) = (Eigen::Vector3d::UnitX() - up.x() * up).normalized();
  R_odom_body.row(2) = up;
  R_odom_body.row(1) = up.cross(R_odom_body.row(0).transpose());
  return R_odom_body;
}

Eigen::Vector3d bodyVelocity(const Eigen::Isometry3d& T_body_imu, const Eigen::Vector3d& velocity_imu,
                             const Eigen::Vector3d& angular_velocity_imu) {
  const Eigen::Vector3d rate = T_body_imu.linear() * angular_velocity_imu;
  return T_body_imu.linear() * velocity_imu - rate.cross(T_body_imu.translation());
}

Eigen::Vector3d imuVelocity(const Eigen::Isometry3d& T_body_imu, const Eigen::Vector3d& velocity_body,
                            const Eigen::Vector3d& angular_velocity_imu) {
  const Eigen::Vector3d rate = T_body_imu.linear() * angular_velocity_imu;
  return T_body_imu.linear().transpose() * (velocity_body + rate.cross(T_body_imu.translation()));
}

Eigen::Isometry3d imuRelativePose(const Eigen::Isometry3d& T_body_imu, const Eigen::Isometry3d& T_body1_body2) {
  return T_body_imu.inverse() * T_body1_body2 * T_body_imu;
}

Eigen::Isometry3d bodyRelativePose(const Eigen::Isometry3d& T_body_imu, const Eigen::Isometry3d& T_imu1_imu2) {
  return T_body_imu * T_imu1_imu2 * T_body_imu.inverse();
}

}  // namespace multicam_egomotion
