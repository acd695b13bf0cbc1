// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "multicam_egomotion/estimation/bundle_adjustment.h"
#include "multicam_egomotion/odometry/window.h"

namespace multicam_egomotion {

/// Covariances of a solved window whose last two poses are the previous and the newest frame: absolute, relative (from
/// everything and from the images alone), of the calibration, and what vision sees of the scale (contracts 4 and 7).
/// `white_share`: part of the image noise's variance that counts between two frames (ImageNoise::whiteShare).
/// `length_sigma`: of all lengths, by the distances between cameras [1]. `considered_variances`: of what is considered
/// of the calibration.
void computeMarginals(BundleAdjustment* bundle, const BundleOptions& options, double white_share, double length_sigma,
                      const Eigen::VectorXd& considered_variances, WindowEstimate* estimate);

/// The images alone (with covariance) see another rotation than the prior, by far more than the uncertainty of both:
/// the gyroscope is wrong (saturated, broken, on another clock).
bool contradicted(const MotionSummary& prior, const RelativeMotion& vision);

/// Prior on the poses from `count` on (numbered as before) and the calibration that holds all information of `bundle`
/// once the poses before and the landmarks are gone.
BundlePrior marginalizeFirstPoses(int count, BundleAdjustment* bundle, const BundleOptions& options);

}  // namespace multicam_egomotion
