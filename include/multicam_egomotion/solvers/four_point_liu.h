// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

#include "multicam_egomotion/geometry/ray.h"
#include "multicam_egomotion/solvers/relative_pose.h"
#include "multicam_egomotion/solvers/solver_priors.h"

namespace multicam_egomotion {

/// Relative pose of a multi-camera system from four ray correspondences and the vertical direction in both frames, for
/// small rotations (4pt-Liu, a baseline). To first order in the yaw θ, counted from the rotation between the aligned
/// frames that turns the body least,
///   R ≈ R_aligned_body2ᵀ (I + θ [z]×) R_aligned_body1,
/// the generalized epipolar constraints (paper, equation b2) are (M0 + θ M1) [t; 1] = 0: det = 0 is a quartic in θ,
/// solved in closed form. R is the rotation nearest to I + θ [z]×, by the angle atan θ; its error grows with the square
/// of the angle.
/// Returns all real solutions of the approximate problem (at most 4). R = I, t = 0, which intra-camera samples have
/// whenever the tilt is the same in both frames, is left out as the root θ = 0 (a cubic remains) unless it is double:
/// then scale_observable is false. A sample of one camera pair is kCentral.
/// L. Liu, H. Li, Y. Dai, Q. Pan: Robust and Efficient Relative Pose with a Multi-Camera System for Autonomous Driving
/// in Highly Dynamic Environments, IEEE T-ITS 2018 (arXiv 2017).
PoseCandidates<4> solveFourPointLiu(const std::array<RayCorrespondence, 4>& sample, const VerticalPrior& prior,
                                    const SolverOptions& options = {});

}  // namespace multicam_egomotion
