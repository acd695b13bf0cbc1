// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "multicam_egomotion/geometry/so3.h"
#include "multicam_egomotion/imu/imu_mounting.h"
#include "multicam_egomotion/imu/inertial_state.h"

namespace multicam_egomotion {
namespace {

/// 99.9 % quantile of χ² for 2 and 3 degrees of freedom.
constexpr double chiSquareGate(int degrees_of_freedom) { return degrees_of_freedom == 2 ? 13.816 : 16.266; }

constexpr double kKnownVertical = 0.0175;  // sigma of its tilt: 1 deg [rad]
constexpr double kKeptDoubt = 0.7;         // of the doubt in the gyroscope, from frame to frame
constexpr double kIgnoredDoubt = 10.0;     // times its variance

}  // namespace

void InertialState::ForceWindow::add(const Eigen::Matrix3d& R, const Eigen::Vector3d& force, double dt) {
  duration_s += dt;
  sum += dt * (R * force);
  square_sum += dt * force.squaredNorm();
  rotation_sum += dt * R;
}

double InertialState::ForceWindow::spread() const {
  return std::sqrt(std::max(0.0, square_sum / duration_s - (sum / duration_s).squaredNorm()));
}

bool InertialState::correctRelativeRotation(const Eigen::Matrix3d& R_1_2, const Eigen::Matrix3d& covariance) {
  if (!R_1_2.allFinite() || !R_1_2.isUnitary(1e-6)) {
    ++rotation_counts_.invalid;
    return false;
  }
  const Eigen::Vector3d residual = logSO3(rotationSinceFrame().transpose() * R_1_2);
  Eigen::Matrix<double, 3, kSize> H = Eigen::Matrix<double, 3, kSize>::Zero();
  H.middleCols<3>(kTheta) = R_odom_imu_.transpose();
  H.middleCols<3>(kFrameTheta) = -R_odom_imu_.transpose();
  ErrorState widening = ErrorState::Zero();
  widening.segment<3>(kTheta).setConstant(residual.squaredNorm());
  widening.segment<3>(kGyroscopeBias).setConstant(options_.gyroscope_bias_sigma * options_.gyroscope_bias_sigma);
  const std::uint64_t recoveries = rotation_counts_.recoveries;
  if (!correct(residual, H, covariance, &rotation_counts_, widening)) {
    return false;
  }
  doubtGyroscope(residual, rotation_counts_.recoveries > recoveries);
  if (held_) {  // a rate seen lately is better than an old sample's
    const double duration = std::max(1e-3, 1e-9 * static_cast<double>(last_.stamp_ns - frame_stamp_ns_));
    last_.angular_velocity = logSO3(R_1_2) / duration + gyroscope_bias_;
    rate_seen_ns_ = last_.stamp_ns;
  }
  return true;
}

void InertialState::doubtGyroscope(const Eigen::Vector3d& residual, bool recovered) {
  // Fades even if the gyroscope still disagrees: what lasts is then taken for its bias.
  doubted_rate_density_ *= kKeptDoubt;
  if (doubted_rate_density_ < kIgnoredDoubt * gyroscope_variance_) {
    doubted_rate_density_ = 0.0;
  }
  if (recovered) {
    const double duration = std::max(1e-3, 1e-9 * static_cast<double>(last_.stamp_ns - frame_stamp_ns_));
    doubted_rate_density_ = residual.squaredNorm() / (3.0 * duration);
  }
}

bool InertialState::correctDisplacement(const Eigen::Vector3d& p_1_2, const Eigen::Matrix3d& covariance,
                                        const Eigen::Vector3d& by_length) {
  Eigen::Matrix<double, 3, kSize> H = Eigen::Matrix<double, 3, kSize>::Zero();
  H.middleCols<3>(kDisplacement).setIdentity();
  H.col(kLength) = by_length;
  const Eigen::Vector3d residual = p_1_2 - displacement_ - length_error_ * by_length;
  const double duration = std::max(1e-3, 1e-9 * static_cast<double>(last_.stamp_ns - frame_stamp_ns_));
  return correctMotion(residual, H, covariance, residual.norm() / duration);
}

bool InertialState::correctVelocity(const Eigen::Vector3d& velocity, const Eigen::Matrix3d& covariance) {
  Eigen::Matrix<double, 3, kSize> H = Eigen::Matrix<double, 3, kSize>::Zero();
  H.middleCols<3>(kVelocity).setIdentity();
  const Eigen::Vector3d residual = velocity - velocityInImuAxes();
  return correctMotion(residual, H, covariance, residual.norm());
}

bool InertialState::correctMotion(const Eigen::Vector3d& residual, const Eigen::Matrix<double, 3, kSize>& H,
                                  const Eigen::Matrix3d& covariance, double speed_residual) {
  const double speed_sigma = std::max(speed_residual, options_.initial_velocity_sigma);
  ErrorState widening = ErrorState::Zero();
  widening.segment<2>(kTheta).setConstant(std::pow(options_.motion_acceleration_sigma / options_.gravity, 2));
  widening.segment<3>(kVelocity).setConstant(speed_sigma * speed_sigma);
  widening.segment<3>(kAccelerometerBias)
      .setConstant(options_.accelerometer_bias_sigma * options_.accelerometer_bias_sigma);
  widening.segment<3>(kDisplacement).setConstant(residual.squaredNorm());
  if (!correct(residual, H, covariance, &velocity_counts_, widening)) {
    return false;
  }
  velocity_seen_ns_ = last_.stamp_ns;
  // A velocity known this well tells more about the vertical than the mean force over the window does.
  const double velocity_variance = velocityCovarianceInImuAxes().trace() / 3;
  if (std::sqrt(velocity_variance) < options_.motion_acceleration_sigma * options_.gravity_window_s) {
    window_ = ForceWindow();
  }
  return true;
}

bool InertialState::correctTilt(const Eigen::Matrix3d& R_world_imu, double sigma) {
  if (!R_world_imu.allFinite() || !R_world_imu.isUnitary(1e-6) || !(sigma > 0) || !std::isfinite(sigma)) {
    ++tilt_counts_.invalid;
    return false;
  }
  const Eigen::Vector3d up = R_odom_imu_ * R_world_imu.row(2).transpose();
  const Eigen::Vector2d residual = shortestArc(up, Eigen::Vector3d::UnitZ()).head<2>();
  Eigen::Matrix<double, 2, kSize> H = Eigen::Matrix<double, 2, kSize>::Zero();
  H.middleCols<2>(kTheta).setIdentity();
  ErrorState widening = ErrorState::Zero();
  widening.segment<2>(kTheta).setConstant(residual.squaredNorm());
  return correct(residual, H, sigma * sigma * Eigen::Matrix2d::Identity(), &tilt_counts_, widening);
}

double InertialState::accelerationSigma(const ForceWindow& window, bool still) const {
  const double force = window.sum.norm() / window.duration_s, gravity = options_.gravity;
  const double floor = still ? options_.still_acceleration_sigma : options_.motion_acceleration_sigma;
  // A horizontal acceleration hides in |f|² = g² + a²: at a = 3 m/s² the force is only 0.45 m/s² longer. Of a platform
  // at rest the difference is the accelerometer's bias.
  const double vertical = std::abs(force - gravity);
  const double horizontal = still ? 0.0 : std::sqrt(std::max(0.0, force * force - gravity * gravity));
  const double mismatch = std::max(vertical, horizontal), spread = window.spread();
  return std::sqrt(floor * floor + spread * spread + mismatch * mismatch);
}

void InertialState::correctVertical(const ForceWindow& window, double acceleration_sigma) {
  // Mean force = gravity + mean acceleration of the platform, horizontally; the tilt is that of the window's middle,
  // to which the gyroscope bias carries it.
  const Eigen::Matrix3d R_mean = window.rotation_sum / window.duration_s;
  const Eigen::Vector2d residual = -window.sum.head<2>() / window.duration_s;
  Eigen::Matrix<double, 2, 3> to_tilt;
  to_tilt << 0, options_.gravity, 0, -options_.gravity, 0, 0;
  Eigen::Matrix<double, 2, kSize> H = Eigen::Matrix<double, 2, kSize>::Zero();
  H.middleCols<3>(kTheta) = to_tilt;
  H.middleCols<3>(kGyroscopeBias) = 0.5 * window.duration_s * to_tilt * R_mean;
  H.middleCols<3>(kAccelerometerBias) = -R_mean.topRows<2>();
  CorrectionCounts counts;
  const double variance = acceleration_sigma * acceleration_sigma;
  ErrorState widening = ErrorState::Zero();
  widening.segment<2>(kTheta).setConstant(residual.squaredNorm() / (options_.gravity * options_.gravity));
  // The platform's acceleration goes with its attitude (a drone's thrust keeps its place in the body) and would be
  // taken for an accelerometer bias: the bias is only considered (Schmidt), not learnt here.
  correct(residual, H, variance * Eigen::Matrix2d::Identity(), &counts, widening, false);
}

void InertialState::useGravityWindow() {
  correctVertical(window_, accelerationSigma(window_, false));
  window_ = ForceWindow();
  // Without any velocity its estimate would wander off without bound; the platform's speed does not.
  const double variance = options_.initial_velocity_sigma * options_.initial_velocity_sigma;
  if (velocityCovarianceInImuAxes().trace() / 3 > variance) {
    Eigen::Matrix<double, 3, kSize> H = Eigen::Matrix<double, 3, kSize>::Zero();
    H.middleCols<3>(kVelocity).setIdentity();
    CorrectionCounts counts;
    correct(-velocityInImuAxes(), H, variance * Eigen::Matrix3d::Identity(), &counts, ErrorState::Zero(), false);
  }
}

bool InertialState::correct(const VectorRef& residual, const MatrixRef& H, const MatrixRef& noise,
                            CorrectionCounts* counts, const ErrorState& widening, bool learn_accelerometer_bias) {
  const Eigen::MatrixXd symmetric_noise = 0.5 * (noise + noise.transpose());
  if (!residual.allFinite() || !isPositiveDefinite(symmetric_noise)) {
    ++counts->invalid;
    return false;
  }
  Eigen::MatrixXd innovation = propagated(H, covariance_) + symmetric_noise;
  if (!isPositiveDefinite(innovation)) {
    ++counts->invalid;
    return false;
  }
  counts->squared_mahalanobis = squaredMahalanobis(residual, innovation);
  if (counts->squared_mahalanobis > chiSquareGate(static_cast<int>(residual.size()))) {
    ++counts->rejected;
    if (++counts->consecutive_rejections < options_.rejections_before_recovery) {
      return false;
    }
    ++counts->recoveries;
    covariance_.diagonal() += widening;
    innovation = propagated(H, covariance_) + symmetric_noise;
  }
  counts->consecutive_rejections = 0;
  ++counts->accepted;

  Eigen::MatrixXd gain = symmetricSolve(innovation, H * covariance_).transpose();
  if (!learn_accelerometer_bias) {
    gain.middleRows<3>(kAccelerometerBias).setZero();
  }
  // The filter is linear in small tilts only: while the vertical is being found, what is wrong with it would be taken
  // for an error of the lengths. Without samples nothing is known of them.
  if (!force_seen_ || tiltSigma() > kKnownVertical) {
    gain.row(kLength).setZero();
  }
  const Covariance remaining = Covariance::Identity() - gain * H;  // Joseph form, right for any gain
  covariance_ = propagated(remaining, covariance_) + propagated(gain, symmetric_noise);
  inject(gain * residual);
  return true;
}

Eigen::Matrix3d InertialState::turnError(const Eigen::Vector3d& theta, int block) {
  // Tilt first, then yaw, which after a long time without vision may be large: the remaining tilt error turns with it.
  const Eigen::Matrix3d yaw = expSO3(Eigen::Vector3d(0, 0, theta.z()));
  covariance_.middleRows<3>(block) = (yaw * covariance_.middleRows<3>(block)).eval();
  covariance_.middleCols<3>(block) = (covariance_.middleCols<3>(block) * yaw.transpose()).eval();
  return yaw * expSO3(Eigen::Vector3d(theta.x(), theta.y(), 0));
}

void InertialState::inject(const ErrorState& error) {
  const Eigen::Vector3d velocity_imu = velocityInImuAxes() + error.segment<3>(kVelocity);
  const Eigen::Matrix3d correction = turnError(error.segment<3>(kTheta), kTheta);
  R_odom_imu_ = correction * R_odom_imu_;
  R_odom_frame_ = turnError(error.segment<3>(kFrameTheta), kFrameTheta) * R_odom_frame_;
  window_.sum = correction * window_.sum;
  window_.rotation_sum = correction * window_.rotation_sum;
  v_odom_ = R_odom_imu_ * velocity_imu;
  gyroscope_bias_ += error.segment<3>(kGyroscopeBias);
  accelerometer_bias_ += error.segment<3>(kAccelerometerBias);
  displacement_ += error.segment<3>(kDisplacement);
  length_error_ += error[kLength];
}

}  // namespace multicam_egomotion
