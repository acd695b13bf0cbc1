// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "multicam_egomotion/imu/gyroscope_integration.h"

#include <algorithm>

#include "multicam_egomotion/geometry/so3.h"

namespace multicam_egomotion {

Eigen::Vector3d rotationVectorBetween(const ImuSample& a, const ImuSample& b, const Eigen::Vector3d& bias) {
  const double dt = 1e-9 * static_cast<double>(b.stamp_ns - a.stamp_ns);
  const Eigen::Vector3d rate_a = a.angular_velocity - bias;
  const Eigen::Vector3d rate_b = b.angular_velocity - bias;
  return 0.5 * dt * (rate_a + rate_b) + dt * dt / 12.0 * rate_a.cross(rate_b);
}

GyroscopeRotation integrateGyroscope(const std::vector<ImuSample>& samples, const Eigen::Vector3d& bias,
                                     double noise_density) {
  GyroscopeRotation rotation;
  for (std::size_t i = 1; i < samples.size(); ++i) {
    const double dt = 1e-9 * static_cast<double>(samples[i].stamp_ns - samples[i - 1].stamp_ns);
    const Eigen::Vector3d step = rotationVectorBetween(samples[i - 1], samples[i], bias);
    const Eigen::Matrix3d R_step = expSO3(step);
    rotation.R_1_2 *= R_step;
    // Earlier errors are carried into the new axes; the step's own enters through the right Jacobian.
    const Eigen::Matrix3d noise_to_rotation = rightJacobianSO3(step) * dt;
    rotation.covariance = R_step.transpose() * rotation.covariance * R_step +
                          noise_density * noise_density / dt * noise_to_rotation * noise_to_rotation.transpose();
    rotation.bias_jacobian = R_step.transpose() * rotation.bias_jacobian - noise_to_rotation;
    rotation.duration_s += dt;
    rotation.largest_gap_s = std::max(rotation.largest_gap_s, dt);
  }
  rotation.complete = samples.size() >= 2;
  return rotation;
}

GyroscopeRotation integrateGyroscope(const ImuBuffer& buffer, std::int64_t begin_ns, std::int64_t end_ns,
                                     const Eigen::Vector3d& bias, double noise_density) {
  const bool backwards = end_ns < begin_ns;
  const std::int64_t first = std::min(begin_ns, end_ns);
  const std::int64_t last = std::max(begin_ns, end_ns);
  std::vector<ImuSample> samples;
  const bool complete = buffer.samplesBetween(first, last, &samples);
  GyroscopeRotation rotation = integrateGyroscope(samples, bias, noise_density);
  rotation.complete = complete;
  rotation.largest_gap_s = buffer.largestGap(first, last);
  if (backwards) {
    // R Exp(δ) inverted is Rᵀ Exp(−R δ).
    const Eigen::Matrix3d R = rotation.R_1_2;
    rotation.R_1_2 = R.transpose();
    rotation.covariance = R * rotation.covariance * R.transpose();
    rotation.bias_jacobian = -R * rotation.bias_jacobian;
  }
  return rotation;
}

}  // namespace multicam_egomotion
