// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "multicam_egomotion/estimation/motion_priors.h"
#include "multicam_egomotion/estimation/ray_blocks.h"

namespace multicam_egomotion {

struct TwoViewRefinementOptions {
  int max_iterations = 20;
  double pixel_sigma = 0.5;      ///< image noise expected [px]; counts as much as that of four correspondences
  double robust_width_px = 2.0;  ///< Sampson errors beyond this, or beyond 2 sigmas measured, are down-weighted
};

struct TwoViewEstimate {
  bool success = false;
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();  ///< T_f2_f1 of the paper: body t1 into body t2
  Eigen::Vector3d t = Eigen::Vector3d::Zero();      ///< [m]
  /// Order (t [m], theta [rad]): t_true = t + dt, R_true = Exp(dtheta) R.
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
  double pixel_sigma = 0.0;  ///< image noise that the inliers show [px]; 0: not known
  int iterations = 0;
};

/// Levenberg-Marquardt on the weighted Sampson errors and the priors, to convergence, from the pose, and the noise
/// where it is known, of `start`. The loss (RobustLoss) follows the noise that the inliers show, core 2 and limit 3
/// sigmas, but no error beyond `max_error_px` counts. No success when the result is not finite.
TwoViewEstimate refineTwoView(const RayBlocks<double>& rays, const MotionPriors& priors,
                              const TwoViewRefinementOptions& options, double max_error_px,
                              const TwoViewEstimate& start);

}  // namespace multicam_egomotion
