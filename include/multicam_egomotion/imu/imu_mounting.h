// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace multicam_egomotion {

/// Rotation vector [rad] of the smallest rotation that turns the direction of `from` into that of `to` (neither 0).
Eigen::Vector3d shortestArc(const Eigen::Vector3d& from, const Eigen::Vector3d& to);

/// Level attitude R_odom_body of a body that sees "up" along `up_in_body` (any length but 0): z up, odom +x along the
/// horizontal projection of body x; the shortest arc from `up_in_body` to z when body x is within 30 deg of vertical.
Eigen::Matrix3d levelAttitude(const Eigen::Vector3d& up_in_body);

/// Velocity of the body origin in body axes from that of the IMU in IMU axes; ω is the angular velocity in IMU axes.
Eigen::Vector3d bodyVelocity(const Eigen::Isometry3d& T_body_imu, const Eigen::Vector3d& velocity_imu,
                             const Eigen::Vector3d& angular_velocity_imu);

/// Inverse of bodyVelocity: velocity of the IMU in IMU axes; ω in IMU axes.
Eigen::Vector3d imuVelocity(const Eigen::Isometry3d& T_body_imu, const Eigen::Vector3d& velocity_body,
                            const Eigen::Vector3d& angular_velocity_imu);

/// Relative pose of the IMU from that of the body: T_imu1_imu2 = T_body_imu⁻¹ T_body1_body2 T_body_imu.
Eigen::Isometry3d imuRelativePose(const Eigen::Isometry3d& T_body_imu, const Eigen::Isometry3d& T_body1_body2);

/// Inverse of imuRelativePose.
Eigen::Isometry3d bodyRelativePose(const Eigen::Isometry3d& T_body_imu, const Eigen::Isometry3d& T_imu1_imu2);

}  // namespace multicam_egomotion
