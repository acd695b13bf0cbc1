// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

#include "multicam_egomotion/geometry/ray.h"
#include "multicam_egomotion/solvers/relative_pose.h"
#include "multicam_egomotion/solvers/solver_priors.h"

namespace multicam_egomotion {

/// Relative pose of a multi-camera system from four ray correspondences and the direction of the rotation axis as a
/// quadratic eigenvalue problem (4pt-Sweeney, a baseline): with s = tan(θ / 2) the generalized epipolar constraints
/// (paper, equation b2) are
///   (s² A + s B + C) [t; 1] = 0,  linearized to the 8x8 problem  s [z; s z] = [0 I; -A⁻¹C -A⁻¹B] [z; s z].
/// C is singular for every intra-camera sample and A may be for any. The angle is therefore counted from another one,
/// at the side opposite to which the system is farthest from singular. Returns all real solutions (at most 6), those of
/// solveFourPointAxis; statuses, scale_observable and the samples with fewer solutions as there. C. Sweeney, J. Flynn,
/// M. Turk: Solving for Relative Pose with a Partially Known Rotation is a Quadratic Eigenvalue Problem, 3DV 2014.
PoseCandidates<8> solveFourPointSweeney(const std::array<RayCorrespondence, 4>& sample, const AxisPrior& prior,
                                        const SolverOptions& options = {});

}  // namespace multicam_egomotion
