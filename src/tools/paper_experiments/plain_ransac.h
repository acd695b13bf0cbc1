// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>

#include "multicam_egomotion/estimation/correspondence_set.h"
#include "paper_experiments/paper_solver.h"

namespace multicam_egomotion {

/// What the paper's tables rate of a pair of frames.
struct PairEstimate {
  enum class State {
    kSolved,
    kPredicted,  ///< not from this pair's images: what the motion before lets expect
    kFailed,     ///< nothing
    kUndefined,  ///< the prior says nothing, as there is no rotation
  };
  State state = State::kFailed;
  Eigen::Isometry3d T_f2_f1 = Eigen::Isometry3d::Identity();
};

/// RANSAC as in the paper: uniform samples; of all their solutions that have their points in front of the cameras, the
/// first with the most inliers, as it is. Ends as the robust estimator does by default.
PairEstimate plainRansac(const CorrespondenceSet& set, const PaperSolver& solver, const SolverPriors& priors,
                         std::uint64_t seed);

}  // namespace multicam_egomotion
