// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstdlib>

namespace multicam_egomotion {

/// Samples that a randomized test of the solvers takes per cell of its table: MULTICAM_EGOMOTION_SOLVER_TRIALS where it
/// is set, for the figures of the documentation; else `quick`.
inline int solverTrials(int quick) {
  const char* trials = std::getenv("MULTICAM_EGOMOTION_SOLVER_TRIALS");
  return trials != nullptr ? std::max(1, std::atoi(trials)) : quick;
}

}  // namespace multicam_egomotion
