// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

#include "multicam_egomotion/geometry/ray.h"
#include "multicam_egomotion/solvers/relative_pose.h"
#include "multicam_egomotion/solvers/solver_priors.h"

namespace multicam_egomotion {

/// Relative pose of a multi-camera system from four ray correspondences and the vertical direction in both frames
/// (4pt-Our). With the origin of the world in the point of the first correspondence (x1, q1) <-> (x2, q2),
///   t = t2 - R t1,  t1 = x1 × q1 + λ1 x1,  t2 = x2 × q2 + λ2 x2,
/// the generalized epipolar constraints of the other three are F(s) [λ1 λ2 1]ᵀ = 0 with entries quadratic in
/// s = tan(yaw / 2); det F(s) = 0 has degree 6.
/// Returns all real solutions (at most 6). A sample of one camera pair is kCentral. Three correspondences of one camera
/// pair and one of another give the four solutions in which the three do not meet in their camera centre. The root
/// R = I, t = 0, which intra-camera samples have whenever the tilt is the same in both frames, is left out unless it
/// is double (pure translation): then scale_observable is false.
/// T. Li, Z. Yu, B. Guan, J. Han, W. Lv: Efficient Minimal Solvers for Visual-Inertial Relative Pose Estimation in
/// Multi-Camera Systems, section IV-A.
PoseCandidates<6> solveFourPointVertical(const std::array<RayCorrespondence, 4>& sample, const VerticalPrior& prior,
                                         const SolverOptions& options = {});

/// The same for `count` samples under one prior, eight at a time: less time per sample. Results are those of the
/// function above; `candidates` has room for `count`.
void solveFourPointVertical(const std::array<RayCorrespondence, 4>* samples, int count, const VerticalPrior& prior,
                            const SolverOptions& options, PoseCandidates<6>* candidates);

}  // namespace multicam_egomotion
