// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "multicam_egomotion/estimation/ray_blocks.h"
#include "multicam_egomotion/estimation/robust_loss.h"

namespace multicam_egomotion {

/// Pose of the first camera of a pair seen from the second, in body axes: the epipolar geometry of the pair.
struct PairGeometry {
  Eigen::Matrix3d R;         ///< R_f2_f1
  Eigen::Vector3d baseline;  ///< unit; zero where the two centres coincide
};

/// Sums over the correspondences of one camera pair.
struct PairSums {
  double H[21] = {};  ///< weighted squares of the gradient, lower triangle row by row; by (unit baseline, d theta)
  double g[6] = {};   ///< weighted gradient times error
  double loss = 0.0;
  double core_weight = 0.0, core_squares = 0.0;  ///< weights of the errors within the core, and their squares [px^2]
  double parallax = 0.0;                         ///< weighted sum of their squared parallaxes [rad^2]
  double parallax_noise = 0.0;  ///< of which a pixel of noise along each axis of both images feigns half [rad^2/px^2]
};

/// Of one correspondence.
struct RayResidual {
  double error;             ///< absolute [px]; infinite for a point behind a camera
  double nearness;          ///< the baseline over the distance of the point at t2
  double squared_parallax;  ///< squared sine of the angle between the bearings
};

/// Centres closer than this coincide [m].
constexpr double kNoBaseline = 1e-12;

/// Sampson errors, first order in the pixel noise of both images. A point that would have to lie behind a camera by
/// more than the loss's limit of image motion counts as an outlier. Sum of the losses of `count` blocks, all of
/// weight 1.
double sumOfLosses(const RayBlock<float>* blocks, int count, const PairGeometry& geometry, const RobustLoss& loss);

/// Adds to the sums over `count` blocks.
void accumulate(const RayBlock<double>* blocks, int count, const PairGeometry& geometry, const RobustLoss& loss,
                PairSums* sums);
void accumulate(const RayBlock<float>* blocks, int count, const PairGeometry& geometry, const RobustLoss& loss,
                PairSums* sums);

/// Residuals of all places of `count` blocks, blank ones included.
void evaluateRays(const RayBlock<double>* blocks, int count, const PairGeometry& geometry, double limit,
                  RayResidual* residuals);

}  // namespace multicam_egomotion
