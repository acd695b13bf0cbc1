// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "multicam_egomotion/imu/inertial_state.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "multicam_egomotion/geometry/so3.h"
#include "multicam_egomotion/imu/gyroscope_integration.h"
#include "multicam_egomotion/imu/imu_mounting.h"

namespace multicam_egomotion {
namespace {

constexpr double kMinInitializationS = 0.1;
constexpr double kMinStillS = 0.3;  // quiet for less may as well be a smooth curve
constexpr double kMaxStepS = 0.02;
constexpr int kMaxSteps = 500;
constexpr double kSpacingGain = 0.1;  // of the newest sample in the mean spacing

void requirePositive(const char* name, double value) {
  if (!(value > 0) || !std::isfinite(value)) {
    throw std::invalid_argument(std::string(name) + ": found " + std::to_string(value) +
                                ", expected a positive number");
  }
}

void requireNotNegative(const char* name, double value) {
  if (!(value >= 0) || !std::isfinite(value)) {
    throw std::invalid_argument(std::string(name) + ": found " + std::to_string(value) + ", expected 0 or more");
  }
}

double square(double x) { return x * x; }

double secondsBetween(const ImuSample& a, const ImuSample& b) {
  return 1e-9 * static_cast<double>(b.stamp_ns - a.stamp_ns);
}

/// Finite and within what any IMU can measure.
bool usable(const ImuSample& sample) {
  return sample.angular_velocity.squaredNorm() < 1e4 && sample.linear_acceleration.squaredNorm() < 1e7;
}

/// Standard deviation of each axis.
Eigen::Vector3d spreadOf(const std::vector<ImuSample>& samples, Eigen::Vector3d ImuSample::*value) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  Eigen::Vector3d square = Eigen::Vector3d::Zero();
  for (const ImuSample& sample : samples) {
    mean += sample.*value;
  }
  mean /= static_cast<double>(samples.size());
  for (const ImuSample& sample : samples) {
    square += (sample.*value - mean).cwiseAbs2();
  }
  return (square / static_cast<double>(samples.size())).cwiseSqrt();
}

}  // namespace

InertialState::InertialState(const ImuCalibration& calibration, const InertialStateOptions& options)
    : options_(options), R_body_imu_(calibration.T_body_imu.linear()) {
  requirePositive("gyroscope_noise_density", calibration.gyroscope_noise_density);
  requirePositive("gyroscope_random_walk", calibration.gyroscope_random_walk);
  requirePositive("accelerometer_noise_density", calibration.accelerometer_noise_density);
  requirePositive("accelerometer_random_walk", calibration.accelerometer_random_walk);
  requirePositive("gravity", options.gravity);
  requirePositive("initial_velocity_sigma", options.initial_velocity_sigma);
  requirePositive("gyroscope_bias_sigma", options.gyroscope_bias_sigma);
  requirePositive("accelerometer_bias_sigma", options.accelerometer_bias_sigma);
  requireNotNegative("gyroscope_noise_floor", options.gyroscope_noise_floor);
  requireNotNegative("accelerometer_noise_floor", options.accelerometer_noise_floor);
  requireNotNegative("gyroscope_scale_sigma", options.gyroscope_scale_sigma);
  requireNotNegative("accelerometer_scale_sigma", options.accelerometer_scale_sigma);
  requireNotNegative("scale_error_time_s", options.scale_error_time_s);
  requireNotNegative("length_sigma", options.length_sigma);
  requireNotNegative("accelerometer_lasting_scale_sigma", options.accelerometer_lasting_scale_sigma);
  requireNotNegative("motion_bandwidth_hz", options.motion_bandwidth_hz);
  requirePositive("motion_acceleration_sigma", options.motion_acceleration_sigma);
  requirePositive("still_acceleration_sigma", options.still_acceleration_sigma);
  requirePositive("still_rate_sigma", options.still_rate_sigma);
  requirePositive("gravity_window_s", options.gravity_window_s);
  requirePositive("max_sample_gap_s", options.max_sample_gap_s);
  requirePositive("gap_rate_sigma", options.gap_rate_sigma);
  requirePositive("gap_acceleration_sigma", options.gap_acceleration_sigma);
  requirePositive("rejections_before_recovery", options.rejections_before_recovery);
  gyroscope_variance_ = square(calibration.gyroscope_noise_density) + square(options.gyroscope_noise_floor);
  accelerometer_variance_ = square(calibration.accelerometer_noise_density) + square(options.accelerometer_noise_floor);
  gyroscope_walk_variance_ = square(calibration.gyroscope_random_walk);
  accelerometer_walk_variance_ = square(calibration.accelerometer_random_walk);
  sample_spacing_ = 1.0 / calibration.rate_hz;
  if (options.length_sigma > 0.0) {
    covariance_(kLength, kLength) = square(options.length_sigma) + square(accelerometerScaleSigma());
  }
  forgetBiases();
}

void InertialState::forgetBiases() {
  gyroscope_bias_.setZero();
  accelerometer_bias_.setZero();
  for (const int block : {kGyroscopeBias, kAccelerometerBias}) {
    covariance_.middleRows<3>(block).setZero();
    covariance_.middleCols<3>(block).setZero();
    const double sigma = block == kGyroscopeBias ? options_.gyroscope_bias_sigma : options_.accelerometer_bias_sigma;
    covariance_.block<3, 3>(block, block) = sigma * sigma * Eigen::Matrix3d::Identity();
  }
}

bool InertialState::initialize(const std::vector<ImuSample>& samples, const Eigen::Vector3d* up) {
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (!usable(samples[i]) || (i > 0 && samples[i].stamp_ns <= samples[i - 1].stamp_ns)) {
      ++ignored_samples_;
      return false;
    }
  }
  if (samples.size() < 3 || secondsBetween(samples.front(), samples.back()) < kMinInitializationS) {
    return false;
  }

  const Eigen::Matrix<double, 6, 6> bias_covariance = covariance_.block<6, 6>(kGyroscopeBias, kGyroscopeBias);
  const double length_variance = covariance_(kLength, kLength);
  covariance_.setZero();
  covariance_.block<6, 6>(kGyroscopeBias, kGyroscopeBias) = bias_covariance;
  covariance_(kLength, kLength) = length_variance;
  const double velocity_variance = options_.initial_velocity_sigma * options_.initial_velocity_sigma;
  covariance_.block<3, 3>(kVelocity, kVelocity) = velocity_variance * Eigen::Matrix3d::Identity();
  covariance_(kTheta, kTheta) = covariance_(kTheta + 1, kTheta + 1) = 1.0;  // no idea before the accelerometer is asked

  started_still_ = secondsBetween(samples.front(), samples.back()) > kMinStillS &&
                   spreadOf(samples, &ImuSample::angular_velocity).maxCoeff() < options_.still_rate_spread &&
                   spreadOf(samples, &ImuSample::linear_acceleration).maxCoeff() < options_.still_acceleration_spread;
  if (started_still_) {
    Eigen::Vector3d mean_rate = Eigen::Vector3d::Zero();
    for (const ImuSample& sample : samples) {
      mean_rate += sample.angular_velocity / static_cast<double>(samples.size());
    }
    Eigen::Matrix<double, 3, kSize> H = Eigen::Matrix<double, 3, kSize>::Zero();
    H.middleCols<3>(kGyroscopeBias).setIdentity();
    CorrectionCounts counts;
    const double sigma = options_.still_rate_sigma;
    started_still_ = correct(mean_rate - gyroscope_bias_, H, sigma * sigma * Eigen::Matrix3d::Identity(), &counts,
                             ErrorState::Zero());
  }

  ForceWindow window;  // in IMU axes at the end
  Eigen::Matrix3d R_end_now = Eigen::Matrix3d::Identity();
  for (std::size_t i = samples.size() - 1; i > 0; --i) {
    const double dt = secondsBetween(samples[i - 1], samples[i]);
    const Eigen::Matrix3d R_step = expSO3(rotationVectorBetween(samples[i - 1], samples[i], gyroscope_bias_));
    window.add(R_end_now, samples[i].linear_acceleration - accelerometer_bias_, 0.5 * dt);
    R_end_now *= R_step.transpose();
    window.add(R_end_now, samples[i - 1].linear_acceleration - accelerometer_bias_, 0.5 * dt);
  }
  if (window.sum.norm() < 1e-3 * window.duration_s) {  // free fall shows no vertical
    return false;
  }
  const double acceleration_sigma = accelerationSigma(window, started_still_);
  if (up) {
    window.sum = window.sum.norm() * *up;
  }
  R_odom_imu_ = levelAttitude(R_body_imu_ * window.sum) * R_body_imu_;
  window.sum = R_odom_imu_ * window.sum;
  window.rotation_sum = R_odom_imu_ * window.rotation_sum;
  v_odom_.setZero();
  last_ = samples.back();
  correctVertical(window, acceleration_sigma);
  window_ = ForceWindow();
  held_ = false;
  rate_seen_ns_ = velocity_seen_ns_ = 0;
  doubted_rate_density_ = 0.0;
  initialized_ = true;
  markFrame();
  return true;
}

void InertialState::propagate(const ImuSample& sample) { propagate(sample, 0.0); }

void InertialState::propagate(const ImuSample& sample, double spacing_s) {
  if (!initialized_ || !usable(sample) || sample.stamp_ns <= last_.stamp_ns) {
    ++ignored_samples_;
    return;
  }
  // The rate and acceleration that a gap leaves unseen are constant over it: the variance of their integral, spread
  // evenly. Their part between samples is what a straight line misses.
  const double gap_s = std::max(spacing_s, secondsBetween(last_, sample));
  const double known = square(accelerometerScaleSigma());
  sample_spacing_ += kSpacingGain * (std::min(gap_s, options_.max_sample_gap_s) - sample_spacing_);
  if (options_.length_sigma > 0.0) {
    covariance_(kLength, kLength) += std::max(0.0, square(accelerometerScaleSigma()) - known);
  }
  const double share = std::min(1.0, square(gap_s / options_.max_sample_gap_s));
  Unseen unseen;
  unseen.rate_density = gap_s * square(share * options_.gap_rate_sigma);
  unseen.force_density = gap_s * square(share * options_.gap_acceleration_sigma);
  unseen.force = share == 1.0;
  advance(sample, unseen);
  held_ = false;
}

void InertialState::hold(std::int64_t stamp_ns, std::int64_t latest_sample_ns) {
  // Variance grows with the square of the time. Samples of later only, as after a gap of the buffer, tell nothing.
  const auto since = [&](std::int64_t known_ns) {
    known_ns = std::min(known_ns, last_.stamp_ns);
    return 1e-9 * static_cast<double>((last_.stamp_ns - known_ns) + (stamp_ns - known_ns));
  };
  Unseen unseen;
  unseen.rate_density = since(std::max(latest_sample_ns, rate_seen_ns_)) * square(options_.gap_rate_sigma);
  unseen.force_density = since(std::max(latest_sample_ns, velocity_seen_ns_)) * square(options_.gap_acceleration_sigma);
  unseen.force = true;
  ImuSample held = last_;
  held.stamp_ns = stamp_ns;
  advance(held, unseen);
  held_ = true;
}

void InertialState::advance(const ImuSample& sample, const Unseen& unseen) {
  const ImuSample begin = last_;
  const double wanted = std::ceil(secondsBetween(begin, sample) / kMaxStepS);
  const int steps = static_cast<int>(std::min(wanted, static_cast<double>(kMaxSteps)));
  for (int i = 1; i < steps; ++i) {
    step(interpolate(begin, sample, begin.stamp_ns + (sample.stamp_ns - begin.stamp_ns) / steps * i), unseen);
  }
  step(sample, unseen);
}

bool InertialState::propagateTo(std::int64_t stamp_ns, const ImuBuffer& buffer) {
  if (!initialized_ || stamp_ns < last_.stamp_ns) {
    return false;
  }
  const bool complete = buffer.samplesBetween(last_.stamp_ns, stamp_ns, &scratch_);
  for (const ImuSample& sample : scratch_) {
    if (sample.stamp_ns == last_.stamp_ns) {
      if (usable(sample)) {
        last_ = sample;  // it may have been held until now
        held_ = false;
      }
    } else {
      propagate(sample, buffer.spacingBefore(sample.stamp_ns));
    }
  }
  if (last_.stamp_ns < stamp_ns) {
    hold(stamp_ns, buffer.latestUsedStamp());
  }
  return complete;
}

void InertialState::step(const ImuSample& sample, const Unseen& unseen) {
  const double dt = secondsBetween(last_, sample);
  const Eigen::Vector3d rotation = rotationVectorBetween(last_, sample, gyroscope_bias_);
  const Eigen::Vector3d force_before = last_.linear_acceleration - accelerometer_bias_;
  const Eigen::Vector3d force_after = sample.linear_acceleration - accelerometer_bias_;
  const Eigen::Matrix3d R_step = expSO3(rotation);
  const Eigen::Matrix3d R_middle = R_odom_imu_ * expSO3(0.5 * rotation);
  const Eigen::Matrix3d R_after = Eigen::Quaterniond(R_odom_imu_ * R_step).normalized().toRotationMatrix();
  const Eigen::Vector3d force = 0.5 * (R_odom_imu_ * force_before + R_after * force_after);
  Eigen::Vector3d acceleration = force - options_.gravity * Eigen::Vector3d::UnitZ();
  if (unseen.force) {
    acceleration.setZero();
  }

  propagateCovariance(rotation / dt, acceleration, R_middle, dt, unseen);
  const Eigen::Matrix3d rate_to_rotation = dt * rightJacobianSO3(rotation);
  const double rate_density = gyroscope_variance_ + unseen.rate_density + doubted_rate_density_;
  rotation_noise_ = (R_step.transpose() * rotation_noise_ * R_step +
                     rate_density / dt * rate_to_rotation * rate_to_rotation.transpose())
                        .eval();
  rotation_bias_jacobian_ = (R_step.transpose() * rotation_bias_jacobian_ - rate_to_rotation).eval();

  displacement_ += R_odom_frame_.transpose() * (v_odom_ * dt + 0.5 * dt * dt * acceleration);
  v_odom_ += acceleration * dt;
  R_odom_imu_ = R_after;
  last_ = sample;

  if (unseen.force) {
    force_seen_ = false;
    window_ = ForceWindow();
    return;
  }
  window_.add(R_middle, 0.5 * (force_before + force_after), dt);
  if (window_.duration_s >= options_.gravity_window_s) {
    useGravityWindow();
  }
}

void InertialState::propagateCovariance(const Eigen::Vector3d& rate, const Eigen::Vector3d& acceleration,
                                        const Eigen::Matrix3d& R, double dt, const Unseen& unseen) {
  const Eigen::Matrix3d R_T = R.transpose();
  const Eigen::Matrix3d R_frame_T = R_odom_frame_.transpose();
  const Eigen::Vector3d velocity_imu = R_T * v_odom_;
  const Eigen::Vector3d gravity(0, 0, -options_.gravity);

  // Continuous error dynamics; δω = −δb_g − n_g, δf = −δb_a − n_a.
  Covariance F = Covariance::Zero();
  F.block<3, 3>(kTheta, kGyroscopeBias) = -R;
  F.block<3, 3>(kVelocity, kVelocity) = -skew(rate);
  F.block<3, 3>(kVelocity, kGyroscopeBias) = -skew(velocity_imu);
  if (!unseen.force) {
    F.block<3, 3>(kVelocity, kTheta) = R_T * skew(gravity);
    F.block<3, 3>(kVelocity, kAccelerometerBias) = -Eigen::Matrix3d::Identity();
  }
  F.block<3, 3>(kDisplacement, kVelocity) = R_frame_T * R;
  F.block<3, 3>(kDisplacement, kTheta) = -R_frame_T * skew(v_odom_);
  F.block<3, 3>(kDisplacement, kFrameTheta) = R_frame_T * skew(v_odom_);
  const Covariance transition = Covariance::Identity() + dt * F + 0.5 * dt * dt * F * F;

  // A scale error is constant over its correlation time: as white noise it has the same effect over longer times.
  const double rate_density = gyroscope_variance_ + unseen.rate_density + doubted_rate_density_ +
                              options_.scale_error_time_s * square(options_.gyroscope_scale_sigma) * rate.squaredNorm();
  const double force_density =
      accelerometer_variance_ + unseen.force_density +
      options_.scale_error_time_s * square(options_.accelerometer_scale_sigma) * acceleration.squaredNorm();
  Eigen::Matrix<double, kSize, 3> rate_to_error = Eigen::Matrix<double, kSize, 3>::Zero();
  rate_to_error.middleRows<3>(kTheta) = -R;
  rate_to_error.middleRows<3>(kVelocity) = -skew(velocity_imu);

  covariance_ = propagated(transition, covariance_);
  covariance_ += dt * rate_density * rate_to_error * rate_to_error.transpose();
  covariance_.block<3, 3>(kVelocity, kVelocity).diagonal().array() += dt * force_density;
  covariance_.block<3, 3>(kGyroscopeBias, kGyroscopeBias).diagonal().array() += gyroscope_walk_variance_ * dt;
  covariance_.block<3, 3>(kAccelerometerBias, kAccelerometerBias).diagonal().array() +=
      accelerometer_walk_variance_ * dt;
}

void InertialState::markFrame() {
  R_odom_frame_ = R_odom_imu_;
  frame_stamp_ns_ = last_.stamp_ns;
  force_seen_ = true;
  displacement_.setZero();
  rotation_noise_.setZero();
  rotation_bias_jacobian_.setZero();
  covariance_.middleRows<3>(kFrameTheta) = covariance_.middleRows<3>(kTheta).eval();
  covariance_.middleCols<3>(kFrameTheta) = covariance_.middleCols<3>(kTheta).eval();
  covariance_.middleRows<3>(kDisplacement).setZero();
  covariance_.middleCols<3>(kDisplacement).setZero();
}

void InertialState::restartAt(std::int64_t stamp_ns, double attitude_sigma) {
  last_.stamp_ns = stamp_ns;
  v_odom_.setZero();
  covariance_.middleRows<3>(kVelocity).setZero();
  covariance_.middleCols<3>(kVelocity).setZero();
  covariance_.block<3, 3>(kVelocity, kVelocity)
      .diagonal()
      .setConstant(options_.initial_velocity_sigma * options_.initial_velocity_sigma);
  covariance_.block<3, 3>(kTheta, kTheta).diagonal().array() += attitude_sigma * attitude_sigma;
  window_ = ForceWindow();
  held_ = false;
  rate_seen_ns_ = velocity_seen_ns_ = 0;
  doubted_rate_density_ = 0.0;
  markFrame();
}

void InertialState::addCommonError(const InertialState& other, double noise_share, double length_share) {
  ErrorState error = ErrorState::Zero();
  error.segment<3>(kTheta) = logSO3(other.R_odom_imu_ * R_odom_imu_.transpose());
  error.segment<3>(kVelocity) = other.velocityInImuAxes() - velocityInImuAxes();
  error.segment<3>(kGyroscopeBias) = other.gyroscope_bias_ - gyroscope_bias_;
  error.segment<3>(kAccelerometerBias) = other.accelerometer_bias_ - accelerometer_bias_;
  error.segment<3>(kFrameTheta) = logSO3(other.R_odom_frame_ * R_odom_frame_.transpose());
  error.segment<3>(kDisplacement) = other.displacement_ - displacement_;
  covariance_ += square(noise_share) * error * error.transpose();
  // Lengths that are too long truly are shorter.
  const double length_sigma = lengthDisagreementSigma();
  ErrorState with_length = length_share * error;
  with_length[kLength] = -length_sigma;
  covariance_.row(kLength).setZero();
  covariance_.col(kLength).setZero();
  covariance_ += with_length * with_length.transpose();
}

Eigen::Matrix3d InertialState::attitudeCovariance() const { return covariance_.block<3, 3>(kTheta, kTheta); }

Eigen::Matrix3d InertialState::frameAttitudeCovariance() const {
  return covariance_.block<3, 3>(kFrameTheta, kFrameTheta);
}

Eigen::Matrix2d InertialState::tiltCovariance() const { return covariance_.block<2, 2>(kTheta, kTheta); }

Eigen::Matrix2d InertialState::frameTiltCovariance() const { return covariance_.block<2, 2>(kFrameTheta, kFrameTheta); }

double InertialState::tiltSigma() const {
  const Eigen::Matrix2d tilt = tiltCovariance();
  const double mean = 0.5 * tilt.trace();
  return std::sqrt(mean + std::sqrt(std::max(0.0, mean * mean - tilt.determinant())));
}

Eigen::Matrix3d InertialState::velocityCovariance() const {
  Eigen::Matrix<double, 3, 6> J;  // to attitude and velocity, which stand next to each other
  J << -skew(v_odom_), R_odom_imu_;
  return propagated(J, covariance_.block<6, 6>(kTheta, kTheta));
}

Eigen::Vector3d InertialState::velocityInImuAxes() const { return R_odom_imu_.transpose() * v_odom_; }

Eigen::Matrix3d InertialState::velocityCovarianceInImuAxes() const {
  return covariance_.block<3, 3>(kVelocity, kVelocity);
}

Eigen::Matrix3d InertialState::rotationSinceFrame() const { return R_odom_frame_.transpose() * R_odom_imu_; }

Eigen::Matrix3d InertialState::rotationSinceFrameCovariance() const {
  const double scale_variance = square(options_.gyroscope_scale_sigma) * logSO3(rotationSinceFrame()).squaredNorm();
  return rotation_noise_ + rotation_bias_jacobian_ * gyroscopeBiasCovariance() * rotation_bias_jacobian_.transpose() +
         scale_variance * Eigen::Matrix3d::Identity();
}

Eigen::Matrix3d InertialState::displacementSinceFrameCovariance() const {
  return covariance_.block<3, 3>(kDisplacement, kDisplacement);
}

// A straight line between samples h apart shortens the amplitude of a motion of angular frequency w by (w h)^2 / 12.
double InertialState::accelerometerScaleSigma() const {
  const double by_spacing = square(2.0 * M_PI * options_.motion_bandwidth_hz * sample_spacing_) / 12.0;
  return std::hypot(options_.accelerometer_lasting_scale_sigma, by_spacing);
}

double InertialState::visionShare() const {
  const double vision = square(options_.length_sigma), accelerometer = square(accelerometerScaleSigma());
  return vision > 0.0 ? vision / (vision + accelerometer) : 0.0;
}

double InertialState::lengthSigma() const {
  const double share = visionShare();
  return std::sqrt(square(share) * covariance_(kLength, kLength) + (1.0 - share) * square(options_.length_sigma));
}

Eigen::Matrix3d InertialState::gyroscopeBiasCovariance() const {
  return covariance_.block<3, 3>(kGyroscopeBias, kGyroscopeBias);
}

Eigen::Matrix3d InertialState::accelerometerBiasCovariance() const {
  return covariance_.block<3, 3>(kAccelerometerBias, kAccelerometerBias);
}

}  // namespace multicam_egomotion
