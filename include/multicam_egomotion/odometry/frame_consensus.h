// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <string>
#include <vector>

#include "multicam_egomotion/estimation/robust_estimator.h"
#include "multicam_egomotion/odometry/track_matches.h"
#include "multicam_egomotion/odometry/window.h"

namespace multicam_egomotion {

/// The motion between two frames that most of the tracks agree on.
struct FrameConsensus {
  bool success = false;
  Eigen::Isometry3d T_previous_body = Eigen::Isometry3d::Identity();  ///< length of the translation may be garbage
  std::vector<TrackId> outliers;                                      ///< tracks with a correspondence that disagrees
  int correspondences = 0, inliers = 0, samples = 0;
  double parallax_px = 0.0;  ///< median image motion of the inliers with the predicted rotation taken out [px]
  std::string solver;
};

/// RANSAC between the previous and the newest frame. `solver`: auto, 4pt-vertical or 4pt-axis (contract 8), but where
/// only one camera sees anything its translation is found with the predicted rotation (2pt-translation). `up`: the
/// vertical in body axes at the previous frame.
FrameConsensus findConsensus(const PosedFrame& previous, const PosedFrame& newest, const MotionSummary& motion,
                             const Eigen::Vector3d& up, const std::string& solver,
                             const RobustEstimatorOptions& options, std::uint64_t seed);

}  // namespace multicam_egomotion
