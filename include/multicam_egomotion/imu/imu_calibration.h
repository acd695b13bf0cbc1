// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <string>

namespace multicam_egomotion {

/// One IMU on the body: where it is and how noisy. Noise as continuous-time densities with Kalibr's names; the defaults
/// suit a consumer MEMS IMU.
struct ImuCalibration {
  std::string frame_id = "imu";
  std::string topic;                                             ///< empty: not stated
  Eigen::Isometry3d T_body_imu = Eigen::Isometry3d::Identity();  ///< IMU pose in the body frame [m]
  double rate_hz = 200.0;                                        ///< nominal [Hz]
  double gyroscope_noise_density = 5e-4;                         ///< [rad/s/sqrt(Hz)]
  double gyroscope_random_walk = 5e-5;                           ///< bias [rad/s^2/sqrt(Hz)]
  double accelerometer_noise_density = 5e-3;                     ///< [m/s^2/sqrt(Hz)]
  double accelerometer_random_walk = 1e-3;                       ///< bias [m/s^3/sqrt(Hz)]
  double mounting_sigma = 0.2 * M_PI / 180.0;  ///< standard deviation of the rotation of T_body_imu, per axis [rad]
};

}  // namespace multicam_egomotion
