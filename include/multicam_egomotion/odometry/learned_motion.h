// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "multicam_egomotion/odometry/window.h"

namespace multicam_egomotion {

/// How much larger an error of the scale may be than its sigma, which knows of noise only.
constexpr double kUnderstatedScale = 2.0;

/// What the motion model may learn from a frame (contract 4).
struct LearnedMotion {
  RelativeMotion vision;
  bool use_displacement = true;
};

/// The displacement where its scale is seen or where nothing moves, else its direction at the length that is predicted.
/// The length's covariance allows for a scale error that lasts from frame to frame: a scale that is still being found
/// would look like an acceleration and tilt the vertical.
/// `predicted`: displacement without vision [m]; `scale_seen`: in the frames before; `parallax_px`: image motion with
/// the rotation taken out; `focal_length` [px].
LearnedMotion learnedMotion(const WindowEstimate& estimate, const Eigen::Vector3d& predicted, bool scale_seen,
                            double parallax_px, double focal_length);

}  // namespace multicam_egomotion
