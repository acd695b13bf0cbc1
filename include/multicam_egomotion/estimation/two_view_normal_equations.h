// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "multicam_egomotion/estimation/motion_priors.h"
#include "multicam_egomotion/estimation/ray_blocks.h"
#include "multicam_egomotion/estimation/robust_loss.h"

namespace multicam_egomotion {

/// What weighs the images, and them against the priors.
struct TwoViewNoise {
  RobustLoss loss;
  double pixel_sigma = 0.5;  ///< of the observations within the loss's core [px]
};

/// Iteratively reweighted least squares on the Sampson errors [px] of T_f2_f1 = [R t], linearized at a pose.
/// Unknowns (d t [m], d theta [rad]): t + d t, Exp(d theta) R.
struct TwoViewNormalEquations {
  Eigen::Matrix<double, 6, 6> H;  ///< of the weighted least squares
  Eigen::Matrix<double, 6, 1> g;  ///< gradient of the cost
  /// H less what noise in the parallaxes feigns of the translation: where a camera hardly moves it is all there is.
  Eigen::Matrix<double, 6, 6> information;
  /// By segment, of H by the baseline: the share of the squared parallaxes that is no noise.
  std::vector<double> shares;
  double cost = 0.0;          ///< half the sum of squares in sigmas, robust, priors included
  double core_weight = 0.0;   ///< weight of the correspondences with an error within the loss's core
  double core_squares = 0.0;  ///< weighted sum of their squared errors [px^2]

  /// -(H + lambda diag H)^-1 g.
  Eigen::Matrix<double, 6, 1> step(double lambda) const;
};

/// A pair tells the direction of its baseline, and of the pose so much the more the shorter that is. What is left of it
/// when the length L has a variance v under a covariance of the pose: L^2 / (L^2 + v), by segment, over that of the
/// pair whose baseline is known best; a scale that all share stays open.
std::vector<double> baselineTrust(const std::vector<RaySegment>& segments, const Eigen::Matrix3d& R,
                                  const Eigen::Vector3d& t, const Eigen::Matrix<double, 6, 6>& covariance);

/// In single precision for steps towards a solution, in double precision for the solution. The information takes
/// `shares` instead of those measured, by segment; none: those measured.
template <class T>
TwoViewNormalEquations linearizeTwoView(const RayBlocks<T>& rays, bool probe_only, const TwoViewNoise& noise,
                                        const MotionPriors& priors, const Eigen::Matrix3d& R, const Eigen::Vector3d& t,
                                        const std::vector<double>& shares = {});

}  // namespace multicam_egomotion
