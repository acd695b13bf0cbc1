// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

#include "multicam_egomotion/geometry/ray.h"
#include "multicam_egomotion/solvers/relative_pose.h"
#include "multicam_egomotion/solvers/solver_priors.h"

namespace multicam_egomotion {

/// Relative pose of a multi-camera system from five ray correspondences and the rotation angle θ (5pt-Martyushev).
/// With the axis n on the unit sphere, R = cosθ I + sinθ [n]× + (1 - cosθ) n nᵀ, the generalized epipolar constraints
///   [(R x1) × x2, x2 · R q1 + q2 · R x1]_i [t; 1] = 0, i = 1 ... 5,
/// have a solution where the five 4x4 minors are zero, polynomials of degree 6 in n: 44 complex solutions.
/// Returns all real solutions, none twice, for any sign of θ and whole turns added: the axis is free. θ = 0 to rounding
/// is kAxisUndefined. Four or five correspondences of one camera pair are kCentral: four are also met by a curve of
/// axes about which the pair's centres coincide, and their other solutions are not sought. Of three correspondences of
/// one pair the eight solutions in which they meet in their camera centre are left out. Where all camera centres move
/// in parallel (θ → 0, or two cameras in line with the axis) the scale is not observable.
/// E. Martyushev, B. Li: Efficient Relative Pose Estimation for Cameras and Generalized Cameras in Case of Known
/// Relative Rotation Angle, 2020.
PoseCandidates<44> solveFivePointMartyushev(const std::array<RayCorrespondence, 5>& sample, const AnglePrior& prior,
                                            const SolverOptions& options = {});

}  // namespace multicam_egomotion
