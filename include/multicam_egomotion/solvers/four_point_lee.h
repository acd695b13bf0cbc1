// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

#include "multicam_egomotion/geometry/ray.h"
#include "multicam_egomotion/solvers/relative_pose.h"
#include "multicam_egomotion/solvers/solver_priors.h"

namespace multicam_egomotion {

/// Relative pose of a multi-camera system from four ray correspondences and the vertical direction in both frames, in
/// the classical formulation (4pt-Lee, a baseline): the generalized epipolar constraints
///   (R x1) · q2 + x2 · (R q1) + x2 · (t × R x1) = 0   (paper, equation b2)
/// are M(s) [t; 1] = 0 with entries quadratic in s = tan(yaw / 2), so that det M(s) = 0 has degree 8, two of its roots
/// being s = ±i: det M = ±(1 + s²) det F with the F of solveFourPointVertical.
/// Returns all real solutions (at most 6), those of solveFourPointVertical; statuses, scale_observable and the samples
/// with fewer solutions as there.
/// G. H. Lee, M. Pollefeys, F. Fraundorfer: Relative Pose Estimation for a Multi-Camera System with Known Vertical
/// Direction, CVPR 2014.
PoseCandidates<8> solveFourPointLee(const std::array<RayCorrespondence, 4>& sample, const VerticalPrior& prior,
                                    const SolverOptions& options = {});

/// Coefficients of det M(s), constant term first, for unit directions and moments divided by the largest norm of
/// the two moments of a correspondence together. The rows
/// are in the order of the sample. All zero where the solver returns a status other than kOk.
std::array<double, 9> leePolynomial(const std::array<RayCorrespondence, 4>& sample, const VerticalPrior& prior);

}  // namespace multicam_egomotion
