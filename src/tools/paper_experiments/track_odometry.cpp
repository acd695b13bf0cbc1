// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "paper_experiments/track_odometry.h"

#include <algorithm>

#include "multicam_egomotion/odometry/ego_motion_options.h"
#include "multicam_egomotion/odometry/learned_motion.h"
#include "paper_experiments/pose_errors.h"

namespace multicam_egomotion {
namespace {

// Of a vertical taken from ground truth, between two frames; the ground truth itself is no better.
constexpr double kTiltSigma = 0.02 * kDegree;

// The rotation turned by the least that takes the vertical at t2 to that at t1; only the heading is as uncertain as it
// was.
void useVertical(const Eigen::Vector3d& up1, const Eigen::Vector3d& up2, MotionSummary* motion) {
  const Eigen::Matrix3d R = motion->T_a_b.linear();
  motion->T_a_b.linear() = Eigen::Quaterniond::FromTwoVectors(R * up2, up1).toRotationMatrix() * R;
  const Eigen::Matrix3d along = up2 * up2.transpose();
  motion->rotation_covariance = up2.dot(motion->rotation_covariance * up2) * along +
                                kTiltSigma * kTiltSigma * (Eigen::Matrix3d::Identity() - along);
}

}  // namespace

TrackOdometry::TrackOdometry(const std::vector<Eigen::Isometry3d>& T_body_cam, double focal_length, std::uint64_t seed)
    : T_body_cam_(T_body_cam),
      focal_length_(focal_length),
      seed_(seed),
      motion_(EgoMotionOptions().constant_rate_sigma, EgoMotionOptions().initial_velocity_sigma),
      window_(WindowOptions()) {}

MotionSummary TrackOdometry::predict(std::int64_t stamp_ns, const std::optional<Eigen::Vector3d>& up_body) {
  if (!motion_.initialized()) motion_.initialize(stamp_ns);
  motion_.advanceTo(stamp_ns);
  MotionSummary motion = motion_.motionSinceFrame();
  previous_up_ = up_;
  up_ = up_body;
  if (up_ && previous_up_) useVertical(*previous_up_, *up_, &motion);
  return motion;
}

TrackOdometry::Step TrackOdometry::add(const TrackedFrame& frame, const MotionSummary& predicted) {
  PosedFrame newest{withoutEnded(frame), T_body_cam_};
  Step step;
  step.T_previous_body = predicted.T_a_b;
  if (!window_.empty()) step.ok = estimate(newest, predicted, &step);
  if (!step.ok) {
    window_.start(frame.stamp_ns, Eigen::Isometry3d::Identity(), Matrix6d::Zero(), newest.frame, T_body_cam_);
    step.keyframe = true;
  }
  ended_.insert(step.outliers.begin(), step.outliers.end());
  motion_.markFrame();
  previous_ = {withoutEnded(newest.frame), T_body_cam_};
  ++frames_;
  return step;
}

bool TrackOdometry::estimate(const PosedFrame& newest, const MotionSummary& predicted, Step* step) {
  const EgoMotionOptions options;
  const Eigen::Vector3d up = previous_up_ ? *previous_up_ : motion_.upAtFrame();
  const FrameConsensus consensus =
      findConsensus(previous_, newest, predicted, up, options.solver, options.ransac, seed_ + frames_);
  if (!consensus.success) return false;
  step->outliers = consensus.outliers;
  ended_.insert(consensus.outliers.begin(), consensus.outliers.end());

  MotionSummary motion = predicted;
  motion.use_translation = true;
  Eigen::Isometry3d along = consensus.T_previous_body;
  along.translation() = along.translation().normalized() * motion.T_a_b.translation().norm();
  const WindowEstimate estimate =
      window_.add(withoutEnded(newest.frame), T_body_cam_, motion, {along, motion.T_a_b, consensus.T_previous_body});
  if (!estimate.ok) return false;
  step->T_previous_body = estimate.relative.T_a_b;
  step->outliers.insert(step->outliers.end(), estimate.outliers.begin(), estimate.outliers.end());
  step->keyframe = estimate.keyframe;

  const LearnedMotion learned =
      learnedMotion(estimate, predicted.T_a_b.translation(), scale_seen_, consensus.parallax_px, focal_length_);
  motion_.correct(learned.vision, learned.use_displacement);
  if (estimate.scale_state != ScaleState::kNotApplicable) {
    scale_seen_ = estimate.scale_state == ScaleState::kObservable;
  }
  return true;
}

TrackedFrame TrackOdometry::withoutEnded(const TrackedFrame& frame) const {
  TrackedFrame kept;
  kept.stamp_ns = frame.stamp_ns;
  for (const FeatureObservation& one : frame.observations) {
    if (ended_.count(one.track) == 0) kept.observations.push_back(one);
  }
  return kept;
}

}  // namespace multicam_egomotion
