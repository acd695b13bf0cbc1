// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "paper_experiments/experiments.h"
#include "paper_experiments/kitti_sequence.h"
#include "paper_experiments/plain_ransac.h"

namespace multicam_egomotion {

/// One method's estimates of a sequence.
struct KittiRun {
  std::string method;                                ///< a solver's name, "ours" or "ours-no-prior"
  std::vector<std::vector<PairEstimate>> estimates;  ///< by seed and pair of frames
};

/// The solvers in plain RANSAC, with priors from the ground truth; then ours complete, with the vertical from the
/// ground truth ("ours"), and with nothing from there ("ours-no-prior"); each with options.ransac_seeds seeds.
/// Tracks the images first, if there are some.
std::vector<KittiRun> runKittiSequence(KittiSequence* sequence, const ExperimentOptions& options);

}  // namespace multicam_egomotion
