// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>

namespace multicam_egomotion {

/// One inertial measurement in the IMU frame.
struct ImuSample {
  std::int64_t stamp_ns = 0;
  Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();     ///< [rad/s]
  Eigen::Vector3d linear_acceleration = Eigen::Vector3d::Zero();  ///< specific force [m/s^2], +g upwards at rest
  /// Attitude R_world_imu as (x, y, z, w) with its tilt sigma [rad], only for imu_orientation: message; sigma < 0:
  /// none.
  Eigen::Vector4d orientation_xyzw = Eigen::Vector4d(0, 0, 0, 1);
  double orientation_sigma = -1.0;
};

/// Stamps beyond are no time [ns]: differences of stamps, and waits added to them, stay within 64 bits.
constexpr std::int64_t kLatestStamp = std::int64_t{1} << 62;

/// Whether the values can be a sensor's: finite, and not larger than any sensor gives.
inline bool plausible(const ImuSample& sample) {
  constexpr double kLargestRate = 1e3, kLargestForce = 1e5;  // [rad/s], [m/s^2]
  return (sample.angular_velocity.array().abs() <= kLargestRate).all() &&
         (sample.linear_acceleration.array().abs() <= kLargestForce).all();
}

}  // namespace multicam_egomotion
