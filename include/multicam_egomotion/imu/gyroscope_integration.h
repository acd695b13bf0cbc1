// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "multicam_egomotion/imu/imu_buffer.h"
#include "multicam_egomotion/imu/imu_sample.h"

namespace multicam_egomotion {

/// Rotation of the IMU between two stamps from its gyroscope.
struct GyroscopeRotation {
  Eigen::Matrix3d R_1_2 = Eigen::Matrix3d::Identity();  ///< p_1 = R_1_2 p_2, both in IMU axes
  /// Sensor noise only, of δ in R_true = R_1_2 Exp(δ) (axes of the IMU at stamp 2) [rad^2]. The bias adds
  /// bias_jacobian Σ_bias bias_jacobianᵀ.
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d bias_jacobian = Eigen::Matrix3d::Zero();  ///< ∂δ/∂bias [s]; about −duration·I for small rotations
  double duration_s = 0.0;                                  ///< time covered by samples
  double largest_gap_s = 0.0;                               ///< longest time between samples, uncovered ends included
  bool complete = false;                                    ///< the samples cover the whole interval
};

/// Rotation vector of the IMU from sample a to sample b for a rate that varies linearly between them: trapezoid plus
/// the coning term dt²/12 ω_a × ω_b (second term of the Magnus series).
Eigen::Vector3d rotationVectorBetween(const ImuSample& a, const ImuSample& b, const Eigen::Vector3d& bias);

/// Rotation between two stamps. Time that no sample covers counts as no rotation, which `complete` reports.
/// begin_ns > end_ns gives the inverse rotation's counterpart: p_begin = R_1_2 p_end holds for any order.
/// `noise_density` is the gyroscope's [rad/s/√Hz].
GyroscopeRotation integrateGyroscope(const ImuBuffer& buffer, std::int64_t begin_ns, std::int64_t end_ns,
                                     const Eigen::Vector3d& bias, double noise_density);

/// The same over samples already taken from a buffer (at least two, in order).
GyroscopeRotation integrateGyroscope(const std::vector<ImuSample>& samples, const Eigen::Vector3d& bias,
                                     double noise_density);

}  // namespace multicam_egomotion
