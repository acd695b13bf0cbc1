// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <vector>

#include "multicam_egomotion/estimation/correspondence_set.h"
#include "multicam_egomotion/estimation/two_view_refinement.h"
#include "multicam_egomotion/solvers/relative_pose.h"

namespace multicam_egomotion {

struct RobustEstimatorOptions {
  double max_epipolar_error_px = 2.0;  ///< Sampson error of an inlier [px]
  double success_probability = 0.9999;
  int max_samples = 500;
  int min_samples = 50;
  int min_inliers = 8;
  double max_rotation_sigmas = 5.0;  ///< hypotheses further from the rotation prior are dropped unscored (contract 8)
  TwoViewRefinementOptions refinement;
};

struct RobustEstimate {
  bool success = false;
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();         ///< T_f2_f1 of the paper: body t1 into body t2
  Eigen::Vector3d t = Eigen::Vector3d::Zero();             ///< [m]; its length is garbage where scale is not observable
  double score = std::numeric_limits<double>::infinity();  ///< MSAC [px^2]
  std::vector<char> inliers;                               ///< by correspondence index
  int inlier_count = 0;
  int samples = 0, models = 0, refinements = 0;
};

/// Models of one minimal sample (indices of correspondences), written into the list; the count is its size.
using ModelGenerator = std::function<void(const int* sample, std::vector<RelativePose>* models)>;

/// RANSAC with MSAC scoring, local optimization of each new best model and adaptive termination. The rotation prior
/// rejects hypotheses before they are scored and enters the refinement.
RobustEstimate estimateRobustly(const CorrespondenceSet& set, int sample_size, const ModelGenerator& generate,
                                const RotationPrior& rotation_prior, const RobustEstimatorOptions& options,
                                std::uint64_t seed);

/// The same over a minimal solver: a type with `kSampleSize`, `Prior` and
/// `static auto solve(const std::array<RayCorrespondence, kSampleSize>&, const Prior&)` that returns a range of
/// RelativePose.
template <class Solver>
RobustEstimate estimate(const CorrespondenceSet& set, const typename Solver::Prior& prior,
                        const RotationPrior& rotation_prior, const RobustEstimatorOptions& options,
                        std::uint64_t seed) {
  std::array<RayCorrespondence, Solver::kSampleSize> rays;
  const ModelGenerator generate = [&](const int* sample, std::vector<RelativePose>* models) {
    for (int i = 0; i < Solver::kSampleSize; ++i) rays[i] = set.rays(sample[i]);
    models->clear();
    for (const RelativePose& model : Solver::solve(rays, prior)) models->push_back(model);
  };
  return estimateRobustly(set, Solver::kSampleSize, generate, rotation_prior, options, seed);
}

}  // namespace multicam_egomotion
