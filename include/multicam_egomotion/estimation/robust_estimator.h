// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <vector>

#include "multicam_egomotion/estimation/correspondence_set.h"
#include "multicam_egomotion/estimation/minimal_sampler.h"
#include "multicam_egomotion/estimation/motion_priors.h"
#include "multicam_egomotion/estimation/scale_observability.h"
#include "multicam_egomotion/estimation/two_view_refinement.h"
#include "multicam_egomotion/solvers/relative_pose.h"

namespace multicam_egomotion {

enum class Score {
  kMsac,           ///< errors truncated at the threshold
  kMarginalizing,  ///< the mean over thresholds from a quarter of it (RobustLoss)
};

struct RobustEstimatorOptions {
  double max_epipolar_error_px = 2.0;  ///< Sampson error of an inlier [px]
  double success_probability = 0.9999;
  int max_samples = 500;
  int min_samples = 50;
  int min_inliers = 8;
  double max_rotation_sigmas = 5.0;  ///< hypotheses further from the rotation prior are dropped unscored (contract 8)
  Sampling sampling = Sampling::kRigAware;
  Score score = Score::kMarginalizing;
  bool local_optimization = true;  ///< of each minimal model that is better than those before
  bool final_refinement = true;    ///< without it there is no covariance, and scale is not judged
  TwoViewRefinementOptions refinement;
};

struct RobustEstimate {
  bool success = false;
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();         ///< T_f2_f1 of the paper: body t1 into body t2
  Eigen::Vector3d t = Eigen::Vector3d::Zero();             ///< [m]; its length is garbage where scale is not observable
  double score = std::numeric_limits<double>::infinity();  ///< of the best model before the final refinement: sum of
                                                           ///< losses between 0 (exact) and 1 (outlier)
  std::vector<char> inliers;                               ///< by correspondence index
  int inlier_count = 0;
  /// Order (t [m], theta [rad]): t_true = t + dt, R_true = Exp(dtheta) R.
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
  double pixel_sigma = 0.0;  ///< image noise that the inliers show [px]
  ScaleObservability scale{std::numeric_limits<double>::infinity(), ScaleState::kNotApplicable};
  int samples = 0, models = 0, refinements = 0;  ///< drawn; scored; local optimizations
};

/// Models of one minimal sample (indices of correspondences), written into the list.
using ModelGenerator = std::function<void(const int* sample, std::vector<RelativePose>* models)>;

/// RANSAC with local optimization of each new best minimal model, adaptive termination and a last refinement by the
/// noise that the inliers show. The rotation prior rejects hypotheses before they are scored; all priors enter the
/// refinements. Deterministic by seed.
RobustEstimate estimateRobustly(const CorrespondenceSet& set, int sample_size, const ModelGenerator& generate,
                                const MotionPriors& priors, const RobustEstimatorOptions& options, std::uint64_t seed);

/// The same over a minimal solver: a type with `kSampleSize`, `Prior` and
/// `static auto solve(const std::array<RayCorrespondence, kSampleSize>&, const Prior&, const SolverOptions&)` that
/// returns a range of RelativePose. It is asked for models that have their points in front of the cameras at t1.
template <class Solver>
RobustEstimate estimate(const CorrespondenceSet& set, const typename Solver::Prior& prior, const MotionPriors& priors,
                        const RobustEstimatorOptions& options, std::uint64_t seed) {
  std::array<RayCorrespondence, Solver::kSampleSize> rays;
  SolverOptions solver_options;
  solver_options.positive_depths_only = true;
  solver_options.camera_centers = set.centers1().data();
  solver_options.camera_count = static_cast<int>(set.centers1().size());
  const ModelGenerator generate = [&](const int* sample, std::vector<RelativePose>* models) {
    for (int i = 0; i < Solver::kSampleSize; ++i) rays[i] = set.rays(sample[i]);
    models->clear();
    for (const RelativePose& model : Solver::solve(rays, prior, solver_options)) models->push_back(model);
  };
  return estimateRobustly(set, Solver::kSampleSize, generate, priors, options, seed);
}

}  // namespace multicam_egomotion
