// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

#include "multicam_egomotion/geometry/ray.h"
#include "multicam_egomotion/solvers/relative_pose.h"
#include "multicam_egomotion/solvers/solver_priors.h"

namespace multicam_egomotion {

/// Relative pose of a multi-camera system from four ray correspondences and the direction of the rotation axis
/// (4pt-Our-Axis). The axis is turned into z in both frames, after which the equations are those of
/// solveFourPointVertical in s = tan(θ / 2). The paper's ω̃ = cot(θ / 2) = 1 / s is infinite at θ = 0.
/// Returns all real solutions (at most 6, 5 for intra-camera samples, 4 for three correspondences of one camera pair
/// and one of another); status and scale_observable as there, kAxisUndefined for a zero axis.
/// T. Li, Z. Yu, B. Guan, J. Han, W. Lv: Efficient Minimal Solvers for Visual-Inertial Relative Pose Estimation in
/// Multi-Camera Systems, section IV-B.
PoseCandidates<6> solveFourPointAxis(const std::array<RayCorrespondence, 4>& sample, const AxisPrior& prior,
                                     const SolverOptions& options = {});

/// The same for `count` samples under one prior, eight at a time: less time per sample. Results are those of the
/// function above; `candidates` has room for `count`.
void solveFourPointAxis(const std::array<RayCorrespondence, 4>* samples, int count, const AxisPrior& prior,
                        const SolverOptions& options, PoseCandidates<6>* candidates);

}  // namespace multicam_egomotion
