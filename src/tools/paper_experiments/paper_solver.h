// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <string>
#include <vector>

#include "multicam_egomotion/geometry/ray.h"
#include "multicam_egomotion/solvers/relative_pose.h"
#include "multicam_egomotion/solvers/solver_priors.h"

namespace multicam_egomotion {

/// What the solvers are told of the rotation.
struct SolverPriors {
  VerticalPrior vertical;
  AxisPrior axis;
  double angle = 0.0;  ///< [rad]
};

enum class PriorKind { kVertical, kAxis, kAngle };

/// Enough correspondences for every solver; each takes the first it needs.
constexpr int kLargestSample = 5;
struct SolverProblem {
  std::array<RayCorrespondence, kLargestSample> rays;
  SolverPriors priors;
};

/// One of the solvers that the paper compares.
struct PaperSolver {
  std::string name;
  PriorKind prior;
  int sample_size;
  /// All real solutions of the first `sample_size` correspondences.
  SolverStatus (*solve)(const RayCorrespondence* sample, const SolverPriors& priors, const SolverOptions& options,
                        std::vector<RelativePose>* solutions);
  /// Time that the solver itself takes for these problems together [s].
  double (*time)(const SolverProblem* problems, int count);
};

/// In the order of the paper's tables.
const std::vector<PaperSolver>& paperSolvers();

}  // namespace multicam_egomotion
