// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "multicam_egomotion/geometry/covariance.h"
#include "multicam_egomotion/geometry/so3.h"
#include "multicam_egomotion/imu/imu_mounting.h"
#include "multicam_egomotion/odometry/learned_motion.h"
#include "multicam_egomotion/odometry/motion_model.h"

namespace multicam_egomotion {
namespace {
constexpr double kMinMessageTiltSigma = 0.0175;      // an orientation message is not believed further than 1 deg [rad]
constexpr double kInitializationSpan = 1.0;          // samples before the first frame that count [s]
constexpr std::int64_t kLatestSamples = 1000000000;  // samples that come later than this are not waited for [ns]
// What calibration and synchronization of camera and IMU leave over, beyond the image noise.
constexpr double kRotationModelSigma = 3e-4;       // [rad]
constexpr double kDisplacementModelSigma = 5e-4;   // [m]
constexpr double kDisplacementModelShare = 0.005;  // of the distance
constexpr double kContradictionMemory = 60.0;      // frames over which the mean is taken: single bursts do not count
constexpr double kMostContradiction = 20.0;        // of one frame
// The start is made again where its vertical proves to have been this far off, and is known so many times better by
// then that what the force told of it hardly counts: what has been seen is used once.
constexpr double kTiltedStart = 0.05;  // [rad]
constexpr double kBetterKnown = 3.0;
// Likewise where the lengths of the motions since the start are so many times better known.
constexpr double kBetterScale = 2.0;
constexpr std::int64_t kLatestNewStart = 2000000000;  // after the start, within the samples kept [ns]

// The motion between the last two frames by the images, with the length that the whole window gives it and without the
// part of its error that all motions of the window have in common.
RelativeMotion withoutScaleError(const WindowEstimate& estimate) {
  RelativeMotion motion = estimate.vision;
  const Eigen::Vector3d direction = motion.T_a_b.translation().normalized();
  motion.T_a_b.translation() = estimate.relative.T_a_b.translation().norm() * direction;
  Matrix6d across = Matrix6d::Identity();
  across.topLeftCorner<3, 3>() -= direction * direction.transpose();
  motion.covariance = propagated(across, motion.covariance);
  const double noise = 0.5 * motion.covariance.topLeftCorner<3, 3>().trace();
  motion.covariance.topLeftCorner<3, 3>() += noise * direction * direction.transpose();
  return motion;
}

}  // namespace

InertialMotion::InertialMotion(const ImuCalibration& calibration, const InertialStateOptions& options,
                               const ImuBuffer* buffer, bool tilt_from_message, double time_sigma,
                               const Eigen::Vector3d& first_camera)
    : calibration_(calibration),
      state_(calibration, options),
      buffer_(buffer),
      tilt_from_message_(tilt_from_message),
      time_sigma_(time_sigma),
      first_camera_(first_camera),
      complete_(state_) {}

void InertialMotion::takeTiltFromMessage() {
  std::vector<ImuSample> samples;
  buffer_->samplesBetween(state_.stamp(), state_.stamp(), &samples);
  if (samples.empty() || !(samples.front().orientation_sigma > 0.0)) return;
  const Eigen::Vector4d& q = samples.front().orientation_xyzw;
  if (!(std::abs(q.norm() - 1.0) < 0.1)) return;
  state_.correctTilt(Eigen::Quaterniond(q).normalized().toRotationMatrix(),
                     std::max(samples.front().orientation_sigma, kMinMessageTiltSigma));
}

bool InertialMotion::initialize(std::int64_t stamp_ns) {
  std::vector<ImuSample> samples;
  buffer_->samplesBetween(stamp_ns - static_cast<std::int64_t>(kInitializationSpan * 1e9), stamp_ns, &samples);
  const InertialState before = state_;
  if (!state_.initialize(samples)) return false;
  start_ = Start{before,
                 std::move(samples),
                 {},
                 Eigen::Matrix3d::Identity(),
                 state_.attitude().row(2).transpose(),
                 state_.tiltSigma()};
  startFromHere();
  propagateTo(stamp_ns);
  markFrame();
  initialized_ = true;
  return true;
}

void InertialMotion::startFromHere() {
  complete_ = state_;
  complete_start_ = start_;
  bridged_.clear();
  newest_ = Frame();
  samples_were_short_ = false;
}

void InertialMotion::propagateTo(std::int64_t stamp_ns) {
  if (!state_.propagateTo(stamp_ns, *buffer_)) samples_were_short_ = true;
  if (tilt_from_message_) takeTiltFromMessage();
}

void InertialMotion::advanceTo(std::int64_t stamp_ns) {
  catchUp();
  propagateTo(stamp_ns);
}

void InertialMotion::markFrame() {
  if (start_) start_->R_start_frame *= state_.rotationSinceFrame();
  state_.markFrame();
  rate_at_frame_ = state_.angularVelocity();
  newest_.stamp_ns = state_.stamp();
  if (start_) start_->frames.push_back(newest_);
  if (samples_were_short_) bridged_.push_back(newest_);
  newest_ = Frame();
  const bool too_late = samples_were_short_ && state_.stamp() - bridged_.front().stamp_ns > kLatestSamples;
  if (start_ && (too_late || state_.stamp() - start_->samples.back().stamp_ns > kLatestNewStart)) start_.reset();
  if (too_late || !samples_were_short_) startFromHere();
}

// Does the bridged frames again once samples have come that reach the first of them.
void InertialMotion::catchUp() {
  const std::int64_t now_ns = state_.stamp();
  if (!samples_were_short_ || buffer_->latestUsedStamp() < (bridged_.empty() ? now_ns : bridged_.front().stamp_ns)) {
    return;
  }
  const std::vector<Frame> frames = std::move(bridged_);
  state_ = complete_;
  start_ = complete_start_;
  startFromHere();
  for (const Frame& frame : frames) {
    propagateTo(frame.stamp_ns);
    if (frame.vision) correct(*frame.vision, frame.scale_seen);
    newest_.measured = frame.measured;
    markFrame();
  }
  if (state_.stamp() < now_ns) propagateTo(now_ns);
}

// Of the rotation since the frame, IMU axes now, by what calibration leaves between camera and IMU: samples that are
// late move both ends of the rotation, and a turned mounting turns its axis.
Eigen::Matrix3d InertialMotion::alignmentCovariance() const {
  const Eigen::Matrix3d R_frame_now = state_.rotationSinceFrame();
  const Eigen::Vector3d by_time = state_.angularVelocity() - R_frame_now.transpose() * rate_at_frame_;
  const Eigen::Matrix3d by_mounting = skew(logSO3(R_frame_now));
  return time_sigma_ * time_sigma_ * by_time * by_time.transpose() +
         std::pow(calibration_.mounting_sigma, 2) * by_mounting * by_mounting.transpose();
}

MotionSummary InertialMotion::motionSinceFrame() const {
  Eigen::Isometry3d T_imu1_imu2 = Eigen::Isometry3d::Identity();
  T_imu1_imu2.linear() = state_.rotationSinceFrame();
  T_imu1_imu2.translation() = state_.displacementSinceFrame();
  const Eigen::Matrix3d R_body_imu = calibration_.T_body_imu.linear();
  MotionSummary motion;
  motion.T_a_b = bodyRelativePose(calibration_.T_body_imu, T_imu1_imu2);
  motion.rotation_covariance = propagated(R_body_imu, state_.rotationSinceFrameCovariance() + alignmentCovariance());
  // The lever arm turns with the body.
  const Eigen::Matrix3d arm = motion.T_a_b.linear() * skew(calibration_.T_body_imu.translation());
  motion.translation_covariance =
      propagated(R_body_imu, state_.displacementSinceFrameCovariance()) + propagated(arm, motion.rotation_covariance);
  return motion;
}

void InertialMotion::correct(const RelativeMotion& vision, bool scale_seen) {
  newest_.vision = vision;
  newest_.scale_seen = scale_seen;
  learn(vision, scale_seen);
  startFromVertical();
}

void InertialMotion::learn(const RelativeMotion& vision, bool scale_seen, bool learn_length) {
  const Eigen::Isometry3d T_imu1_imu2 = imuRelativePose(calibration_.T_body_imu, vision.T_a_b);
  const Eigen::Matrix3d R_imu_body = calibration_.T_body_imu.linear().transpose();
  // From Exp(d) R in the axes of the first frame to R Exp(d) in those of the second.
  const Eigen::Matrix3d to_second = R_imu_body * vision.T_a_b.linear().transpose();
  const Eigen::Matrix3d rotation_covariance = propagated(to_second, vision.covariance.bottomRightCorner<3, 3>()) +
                                              alignmentCovariance() +
                                              kRotationModelSigma * kRotationModelSigma * Eigen::Matrix3d::Identity();
  state_.correctRelativeRotation(T_imu1_imu2.linear(), rotation_covariance);
  if (!scale_seen) return;
  const double share = kDisplacementModelShare * T_imu1_imu2.translation().norm();
  Eigen::Matrix<double, 3, 6> to_imu;  // of the IMU's displacement by that of the body and its rotation
  to_imu << R_imu_body, -R_imu_body * skew(vision.T_a_b.linear() * calibration_.T_body_imu.translation());
  const Eigen::Matrix3d displacement_covariance =
      propagated(to_imu, vision.covariance) +
      (kDisplacementModelSigma * kDisplacementModelSigma + share * share) * Eigen::Matrix3d::Identity();
  const Eigen::Vector3d camera_moved = vision.T_a_b * first_camera_ - first_camera_;
  const Eigen::Vector3d by_length = R_imu_body * camera_moved / (1.0 + state_.lengthDisagreement());
  if (learn_length) {
    state_.correctDisplacement(T_imu1_imu2.translation(), displacement_covariance, by_length);
  } else {
    state_.correctDisplacement(T_imu1_imu2.translation() - state_.lengthDisagreement() * by_length,
                               displacement_covariance);
  }
  const double distance = std::min(state_.velocityCounts().squared_mahalanobis, kMostContradiction);
  contradiction_ += (distance - contradiction_) / kContradictionMemory;
}

// The filter is linear in small angles only: what a wrong vertical at the start makes of gravity stays in the biases.
void InertialMotion::startFromVertical() {
  if (!start_ || samples_were_short_) return;
  const Eigen::Vector3d up = start_->R_start_frame * state_.rotationSinceFrame() * state_.attitude().row(2).transpose();
  if (shortestArc(start_->up, up).norm() < kTiltedStart || kBetterKnown * state_.tiltSigma() > start_->tilt_sigma) {
    return;
  }
  makeStartAnew(up);
}

void InertialMotion::reviseStart(const WindowEstimate& estimate) {
  if (!start_) return;
  // At a frame without vision the window began anew: what it finds out says nothing of the motions before.
  bool same_window = true;
  const auto lengthen = [&](std::vector<Frame>* frames) {
    for (auto frame = frames->rbegin(); frame != frames->rend(); ++frame) {
      same_window = same_window && frame->vision.has_value();
      if (!same_window) frame->measured.reset();
      if (frame->measured) frame->measured->T_a_b.translation() *= estimate.lengthening;
    }
  };
  lengthen(&bridged_);
  lengthen(&complete_start_->frames);
  same_window = true;
  lengthen(&start_->frames);
  if (estimate.scale_state == ScaleState::kNotApplicable) return;
  newest_.measured = withoutScaleError(estimate);
  start_->scale_sigma = std::max(start_->scale_sigma, std::min(1.0, estimate.scale_noise));
  if (estimate.scale_state != ScaleState::kObservable || samples_were_short_ ||
      kBetterScale * estimate.scale_noise > start_->scale_sigma) {
    return;
  }
  start_->scale_sigma = estimate.scale_noise;
  start_->measured = true;
  makeStartAnew(start_->up);
}

void InertialMotion::makeStartAnew(const Eigen::Vector3d& up) {
  replayStart(up, 1.0);
  if (!start_->measured) return;
  // All measured lengths have one error in common, of the images' noise and of the calibration.
  const double noise = kUnderstatedScale * start_->scale_sigma;
  const double both = std::hypot(noise, state_.lengthDisagreementSigma());
  if (both <= 0.0) return;
  InertialMotion longer = *this;
  longer.replayStart(up, 1.0 + both);
  state_.addCommonError(longer.state_, noise / both, state_.lengthDisagreementSigma() / both);
}

void InertialMotion::replayStart(const Eigen::Vector3d& up, double lengthening) {
  const auto learnFrame = [&](const Frame& frame) {
    if (start_->measured && frame.measured) {
      RelativeMotion longer = *frame.measured;
      longer.T_a_b.translation() *= lengthening;
      learn(longer, true, false);
    } else if (frame.vision) {
      learn(*frame.vision, frame.scale_seen);
    }
  };
  const std::int64_t now_ns = state_.stamp();
  const Frame newest = newest_;
  const double contradiction = contradiction_;
  state_ = start_->before;
  state_.initialize(start_->samples, &up);
  start_->up = up;
  start_->R_start_frame.setIdentity();
  for (const Frame& frame : start_->frames) {
    propagateTo(frame.stamp_ns);
    learnFrame(frame);
    start_->R_start_frame *= state_.rotationSinceFrame();
    state_.markFrame();
  }
  startFromHere();
  propagateTo(now_ns);
  newest_ = newest;
  learnFrame(newest);
  contradiction_ = contradiction;
}

Eigen::Vector3d InertialMotion::up() const {
  return calibration_.T_body_imu.linear() * state_.attitude().transpose() * Eigen::Vector3d::UnitZ();
}

Eigen::Vector3d InertialMotion::upAtFrame() const {
  return calibration_.T_body_imu.linear() * state_.frameAttitude().transpose() * Eigen::Vector3d::UnitZ();
}

TwistWithCovariance InertialMotion::twist() const {
  const Eigen::Matrix3d R_body_imu = calibration_.T_body_imu.linear();
  TwistWithCovariance twist;
  twist.angular = R_body_imu * state_.angularVelocity();
  twist.linear = bodyVelocity(calibration_.T_body_imu, state_.velocityInImuAxes(), state_.angularVelocity());
  const double density = calibration_.gyroscope_noise_density;
  const Eigen::Matrix3d rate_covariance =
      state_.gyroscopeBiasCovariance() + density * density * calibration_.rate_hz * Eigen::Matrix3d::Identity();
  const Eigen::Matrix3d arm = skew(calibration_.T_body_imu.translation());
  twist.covariance.bottomRightCorner<3, 3>() = propagated(R_body_imu, rate_covariance);
  twist.covariance.topLeftCorner<3, 3>() = propagated(R_body_imu, state_.velocityCovarianceInImuAxes()) +
                                           propagated(arm, twist.covariance.bottomRightCorner<3, 3>());
  return twist;
}

void InertialMotion::restartAt(std::int64_t stamp_ns, double attitude_sigma) {
  state_.restartAt(stamp_ns, attitude_sigma);
  start_.reset();
  startFromHere();
  initialized_ = state_.initialized();
}

void InertialMotion::reset(bool forget_biases) {
  initialized_ = false;
  if (forget_biases) state_.forgetBiases();
}

}  // namespace multicam_egomotion
