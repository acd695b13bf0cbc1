// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "paper_experiments/paper_solver.h"
#include "paper_experiments/pose_errors.h"
#include "paper_experiments/two_camera_trial.h"

namespace multicam_egomotion {

/// Errors of a solver on a trial; 180 degrees where it has no solution.
struct TrialErrors {
  PoseErrors nearest;  ///< of the solution with the least sum of rotation and direction error
  PoseErrors chosen;   ///< of the solution that the further correspondences choose
  bool solved = false;
};

/// Loss by which a further correspondence votes [px]: poses of minimal samples are some pixels off.
constexpr RobustLoss kVote = {1.0, 10.0};

inline TrialErrors trialErrors(const PaperSolver& solver, const SolverProblem& problem, const TwoCameraTrial& trial,
                               const CorrespondenceSet* further) {
  TrialErrors errors;
  std::vector<RelativePose> solutions;
  solver.solve(problem.rays.data(), problem.priors, {}, &solutions);
  double least = 1e9, least_loss = 1e9;
  for (const RelativePose& solution : solutions) {
    const PoseErrors one = poseErrors(solution.R, solution.t, trial.R(), trial.t());
    errors.solved = true;
    if (one.rotation + one.translation < least) {
      least = one.rotation + one.translation;
      errors.nearest = one;
    }
    if (further == nullptr) continue;
    const double loss = further->sumOfLosses(solution.R, solution.t, kVote, CorrespondenceSet::Part::kAll);
    if (loss < least_loss) {
      least_loss = loss;
      errors.chosen = one;
    }
  }
  return errors;
}

}  // namespace multicam_egomotion
