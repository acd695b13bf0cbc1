// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "multicam_egomotion/estimation/bundle_adjustment.h"
#include "multicam_egomotion/odometry/window.h"

namespace multicam_egomotion {

/// Covariances of a solved window whose last two poses are the previous and the newest frame: absolute, relative (from
/// everything and from the images alone), and what vision sees of the scale (contracts 4 and 7). `white_share`: part of
/// the image noise's variance that counts between two frames (ImageNoise::whiteShare).
void computeMarginals(BundleAdjustment* bundle, const BundleOptions& options, double white_share,
                      WindowEstimate* estimate);

/// The images alone (with covariance) see another rotation than the prior, by far more than the uncertainty of both:
/// the gyroscope is wrong (saturated, broken, on another clock).
bool contradicted(const MotionSummary& prior, const RelativeMotion& vision);

/// Prior on poses 1.. (numbered as before) that holds all information of `bundle` once pose 0 and the landmarks are
/// gone.
PosePrior marginalizeFirstPose(BundleAdjustment* bundle, const BundleOptions& options);

}  // namespace multicam_egomotion
