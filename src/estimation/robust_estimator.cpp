// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "multicam_egomotion/estimation/robust_estimator.h"

#include <algorithm>
#include <cmath>

#include "multicam_egomotion/estimation/rig_sampler.h"
#include "multicam_egomotion/geometry/so3.h"

namespace multicam_egomotion {
namespace {

// Thresholds of the local optimization's rounds, in those of an inlier; it ends when a round gains less than 1 %.
constexpr double kThresholdFactors[] = {3.0, 1.5, 1.0, 1.0, 1.0};
constexpr double kWorthwhile = 0.99;
constexpr int kPolishRounds = 3;
constexpr double kLeastNoise = 0.05;  // [px]

// Grouped positions of the correspondences whose squared error is below the threshold.
std::vector<int> inlierPositions(const std::vector<double>& squared_errors, double squared_threshold) {
  std::vector<int> positions;
  for (std::size_t i = 0; i < squared_errors.size(); ++i) {
    if (squared_errors[i] < squared_threshold) positions.push_back(static_cast<int>(i));
  }
  return positions;
}

// Samples needed to draw one free of outliers with the probability wanted.
double samplesNeeded(double inlier_share, int sample_size, double success_probability) {
  const double all_inliers = std::pow(inlier_share, sample_size);
  if (all_inliers >= 1.0) return 1.0;
  return std::log1p(-success_probability) / std::log1p(-all_inliers);
}

struct RefinedModel {
  Eigen::Matrix3d R;
  Eigen::Vector3d t;
  double score;
};

// Local optimization over the inliers of a threshold that narrows to the final one: a minimal model is too crude to
// have all inliers within it. Returns the number of refinements.
int refine(const CorrespondenceSet& set, const RotationPrior& prior, const RobustEstimatorOptions& options,
           RefinedModel* model) {
  const double squared_threshold = options.max_epipolar_error_px * options.max_epipolar_error_px;
  std::vector<double> errors;
  RefinedModel current = *model;
  int rounds = 0;
  double last = std::numeric_limits<double>::infinity();
  for (double factor : kThresholdFactors) {
    set.squaredSampsonErrors(current.R, current.t, &errors);
    const std::vector<int> support = inlierPositions(errors, factor * factor * squared_threshold);
    ++rounds;
    if (!refineTwoView(set, support, prior, options.refinement, &current.R, &current.t)) break;
    current.score =
        set.score(current.R, current.t, squared_threshold, std::numeric_limits<double>::infinity(), &errors);
    if (current.score < model->score) *model = current;
    if (factor == 1.0 && current.score > kWorthwhile * last) break;
    last = current.score;
  }
  return rounds;
}

// Last refinement, with weights and support by the noise that the inliers show instead of the threshold: it is much
// less, and outliers that lie within the threshold by chance would bend the result.
void polish(const CorrespondenceSet& set, const RotationPrior& prior, const RobustEstimatorOptions& options,
            RobustEstimate* best) {
  const double squared_threshold = options.max_epipolar_error_px * options.max_epipolar_error_px;
  std::vector<double> errors;
  for (int round = 0; round < kPolishRounds; ++round) {
    set.squaredSampsonErrors(best->R, best->t, &errors);
    std::vector<double> inliers;
    for (double error : errors) {
      if (error < squared_threshold) inliers.push_back(error);
    }
    if (static_cast<int>(inliers.size()) < options.min_inliers) return;
    std::nth_element(inliers.begin(), inliers.begin() + inliers.size() / 2, inliers.end());
    const double sigma = 1.4826 * std::sqrt(inliers[inliers.size() / 2]);  // of a Gaussian with that median
    TwoViewRefinementOptions refinement = options.refinement;
    refinement.robust_width_px = std::min(refinement.robust_width_px, std::max(sigma, kLeastNoise));
    const double support = std::min(options.max_epipolar_error_px, 4.0 * refinement.robust_width_px);
    if (!refineTwoView(set, inlierPositions(errors, support * support), prior, refinement, &best->R, &best->t)) return;
    ++best->refinements;
  }
}

}  // namespace

RobustEstimate estimateRobustly(const CorrespondenceSet& set, int sample_size, const ModelGenerator& generate,
                                const RotationPrior& rotation_prior, const RobustEstimatorOptions& options,
                                std::uint64_t seed) {
  RobustEstimate best;
  best.inliers.assign(set.size(), 0);
  if (set.size() < std::max(sample_size, options.min_inliers)) return best;

  const double squared_threshold = options.max_epipolar_error_px * options.max_epipolar_error_px;
  const double max_rotation_square = options.max_rotation_sigmas * options.max_rotation_sigmas;
  RigSampler sampler(set, seed);
  std::vector<int> sample(sample_size);
  std::vector<RelativePose> models;
  std::vector<double> errors;
  double needed = options.max_samples;
  double best_minimal_score = std::numeric_limits<double>::infinity();

  while (best.samples < options.max_samples && (best.samples < options.min_samples || best.samples < needed)) {
    ++best.samples;
    if (!sampler.draw(sample_size, sample.data())) break;
    generate(sample.data(), &models);
    for (const RelativePose& model : models) {
      const Eigen::Vector3d difference = logSO3(model.R * rotation_prior.R.transpose());
      if (difference.dot(rotation_prior.information * difference) > max_rotation_square) continue;
      ++best.models;
      // A minimal model is refined when it is better than the other minimal models were: against a refined one it
      // could hardly win.
      const double score = set.score(model.R, model.t, squared_threshold, best_minimal_score, &errors);
      if (!(score < best_minimal_score)) continue;
      best_minimal_score = score;
      RefinedModel refined{model.R, model.t, score};
      best.refinements += refine(set, rotation_prior, options, &refined);
      if (!(refined.score < best.score)) continue;
      best.score = refined.score;
      best.R = refined.R;
      best.t = refined.t;
      best.success = true;
      set.squaredSampsonErrors(best.R, best.t, &errors);
      const double inliers = static_cast<double>(inlierPositions(errors, squared_threshold).size());
      needed = samplesNeeded(inliers / set.size(), sample_size, options.success_probability);
    }
  }
  if (!best.success) return best;
  polish(set, rotation_prior, options, &best);

  set.squaredSampsonErrors(best.R, best.t, &errors);
  for (int position : inlierPositions(errors, squared_threshold)) {
    best.inliers[set.indexAt(position)] = 1;
    ++best.inlier_count;
  }
  best.success = best.inlier_count >= options.min_inliers;
  return best;
}

}  // namespace multicam_egomotion
