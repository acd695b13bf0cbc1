// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <set>
#include <vector>

#include "multicam_egomotion/odometry/frame_consensus.h"
#include "multicam_egomotion/odometry/motion_model.h"
#include "multicam_egomotion/odometry/window.h"

namespace multicam_egomotion {

/// The chain of EgoMotion from tracks on, without an IMU: constant-rate prediction, RANSAC between two frames, window
/// of keyframes. The vertical may be given, as in the paper's experiments.
class TrackOdometry {
 public:
  /// `focal_length` [px]; `seed` of RANSAC.
  TrackOdometry(const std::vector<Eigen::Isometry3d>& T_body_cam, double focal_length, std::uint64_t seed);

  /// Predicted motion from the last frame to `stamp_ns`. `up_body`: the vertical, if it is known.
  MotionSummary predict(std::int64_t stamp_ns, const std::optional<Eigen::Vector3d>& up_body);

  struct Step {
    bool ok = false;  ///< false: the motion is the predicted one
    Eigen::Isometry3d T_previous_body = Eigen::Isometry3d::Identity();
    std::vector<TrackId> outliers;  ///< tracks that should end
    bool keyframe = false;
  };
  /// Takes the frame for which the motion was predicted. Of the first frame nothing is said.
  Step add(const TrackedFrame& frame, const MotionSummary& predicted);

 private:
  bool estimate(const PosedFrame& newest, const MotionSummary& predicted, Step* step);
  TrackedFrame withoutEnded(const TrackedFrame& frame) const;

  std::vector<Eigen::Isometry3d> T_body_cam_;
  double focal_length_;
  std::uint64_t seed_;
  ConstantRateMotion motion_;
  std::optional<Eigen::Vector3d> up_, previous_up_;  ///< as given
  Window window_;
  PosedFrame previous_;
  std::set<TrackId> ended_;
  bool scale_seen_ = false;
  std::uint64_t frames_ = 0;
};

}  // namespace multicam_egomotion
