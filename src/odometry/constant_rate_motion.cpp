// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "multicam_egomotion/geometry/covariance.h"
#include "multicam_egomotion/geometry/so3.h"
#include "multicam_egomotion/odometry/motion_model.h"

namespace multicam_egomotion {
namespace {
// How a body's velocity changes between two frames, per axis: vehicles brake and hands move with a few m/s^2 [m/s^2].
constexpr double kAccelerationSigma = 3.0;
constexpr double kInitialTiltSigma = 0.1;  // the body is taken to stand level at the start [rad]
}  // namespace

ConstantRateMotion::ConstantRateMotion(double rotation_sigma, double velocity_sigma)
    : rotation_sigma_(rotation_sigma), velocity_sigma_(velocity_sigma) {
  reset(true);
}

bool ConstantRateMotion::initialize(std::int64_t stamp_ns) {
  stamp_ns_ = frame_stamp_ns_ = stamp_ns;
  initialized_ = true;
  return true;
}

MotionSummary ConstantRateMotion::motionSinceFrame() const {
  const double dt = seconds();
  MotionSummary motion;
  motion.T_a_b.linear() = expSO3(twist_.angular * dt);
  motion.T_a_b.translation() = twist_.linear * dt;
  motion.rotation_covariance = rotation_sigma_ * rotation_sigma_ * Eigen::Matrix3d::Identity();
  const double change = kAccelerationSigma * dt;
  motion.translation_covariance =
      dt * dt * (twist_.covariance.topLeftCorner<3, 3>() + change * change * Eigen::Matrix3d::Identity()) +
      1e-8 * Eigen::Matrix3d::Identity();
  return motion;
}

void ConstantRateMotion::correct(const RelativeMotion& vision, bool scale_seen) {
  const double dt = seconds();
  if (dt <= 0.0) return;
  up_at_frame_ = up_;
  up_ = (vision.T_a_b.linear().transpose() * up_).normalized();
  twist_.angular = logSO3(vision.T_a_b.linear()) / dt;
  const Eigen::Matrix3d to_now = vision.T_a_b.linear().transpose();
  const double change = kAccelerationSigma * dt;
  const Eigen::Matrix3d drift = change * change * Eigen::Matrix3d::Identity();
  twist_.linear = (to_now * twist_.linear).eval();
  Eigen::Matrix3d covariance = propagated(to_now, twist_.covariance.topLeftCorner<3, 3>() + drift);
  const Eigen::Vector3d mean_velocity = to_now * vision.T_a_b.translation() / dt;
  if (scale_seen) {
    // The mean velocity since the last frame: half of the change comes after it.
    const Eigen::Matrix3d noise =
        propagated(to_now, vision.covariance.topLeftCorner<3, 3>()) / (dt * dt) + 0.25 * drift;
    const Eigen::Matrix3d gain = symmetricSolve(covariance + noise, covariance).transpose();
    twist_.linear += gain * (mean_velocity - twist_.linear);
    const Eigen::Matrix3d remaining = Eigen::Matrix3d::Identity() - gain;
    covariance = propagated(remaining, covariance) + propagated(gain, noise);
  } else if (mean_velocity.norm() > 1e-9) {  // the direction is vision's, the speed is what it was
    twist_.linear = (mean_velocity.normalized() * twist_.linear.norm()).eval();
  }
  const double largest = velocity_sigma_ * velocity_sigma_;
  if (covariance.trace() > 3.0 * largest) covariance = largest * Eigen::Matrix3d::Identity();
  twist_.covariance.setZero();
  twist_.covariance.topLeftCorner<3, 3>() = covariance;
  twist_.covariance.bottomRightCorner<3, 3>() =
      propagated(to_now, vision.covariance.bottomRightCorner<3, 3>()) / (dt * dt);
}

double ConstantRateMotion::tiltSigma() const { return kInitialTiltSigma; }

void ConstantRateMotion::restartAt(std::int64_t stamp_ns, double /*attitude_sigma*/) {
  const Eigen::Vector3d up = up_;
  reset(false);
  up_ = up_at_frame_ = up;
  initialize(stamp_ns);
}

void ConstantRateMotion::reset(bool /*forget_biases*/) {
  initialized_ = false;
  up_ = up_at_frame_ = Eigen::Vector3d::UnitZ();
  twist_ = TwistWithCovariance();
  twist_.covariance.topLeftCorner<3, 3>() = velocity_sigma_ * velocity_sigma_ * Eigen::Matrix3d::Identity();
  twist_.covariance.bottomRightCorner<3, 3>() = Eigen::Matrix3d::Identity();
}

}  // namespace multicam_egomotion
