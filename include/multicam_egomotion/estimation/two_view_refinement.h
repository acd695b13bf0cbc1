// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "multicam_egomotion/estimation/correspondence_set.h"

namespace multicam_egomotion {

/// Gaussian knowledge of the rotation R_f2_f1 (gyroscope, or constant rate): R_true = Exp(d) R, d ~ N(0, covariance).
struct RotationPrior {
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();  ///< [1/rad^2]; zero: nothing is known
};

struct TwoViewRefinementOptions {
  int max_iterations = 8;
  double pixel_sigma = 0.5;      ///< [px], balances the images against the prior
  double robust_width_px = 2.0;  ///< Sampson errors beyond this are down-weighted (Cauchy)
};

/// Levenberg-Marquardt on the Sampson errors of the correspondences in `inliers` (grouped positions) over rotation and
/// translation of T_f2_f1; refines `R`, `t` in place. Returns false, leaving both, when the result is not finite.
bool refineTwoView(const CorrespondenceSet& set, const std::vector<int>& inliers, const RotationPrior& prior,
                   const TwoViewRefinementOptions& options, Eigen::Matrix3d* R, Eigen::Vector3d* t);

}  // namespace multicam_egomotion
