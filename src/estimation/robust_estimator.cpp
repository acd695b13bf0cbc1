// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "multicam_egomotion/estimation/robust_estimator.h"

#include <algorithm>
#include <cmath>

#include "multicam_egomotion/estimation/rig_sampler.h"
#include "multicam_egomotion/geometry/so3.h"

namespace multicam_egomotion {
namespace {

constexpr int kMaxRefinements = 6;  // of one new best model

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

  while (best.samples < options.max_samples && (best.samples < options.min_samples || best.samples < needed)) {
    ++best.samples;
    if (!sampler.draw(sample_size, sample.data())) break;
    generate(sample.data(), &models);
    for (const RelativePose& model : models) {
      const Eigen::Vector3d difference = logSO3(model.R * rotation_prior.R.transpose());
      if (difference.dot(rotation_prior.information * difference) > max_rotation_square) continue;
      ++best.models;
      const double score = set.score(model.R, model.t, squared_threshold, best.score, &errors);
      if (!(score < best.score)) continue;
      best.score = score;
      best.R = model.R;
      best.t = model.t;
      best.success = true;

      // Local optimization: the new best, refined over its inliers as long as that gains more.
      set.squaredSampsonErrors(best.R, best.t, &errors);
      std::vector<int> support = inlierPositions(errors, squared_threshold);
      for (int round = 0; round < kMaxRefinements; ++round) {
        Eigen::Matrix3d R = best.R;
        Eigen::Vector3d t = best.t;
        ++best.refinements;
        if (!refineTwoView(set, support, rotation_prior, options.refinement, &R, &t)) break;
        const double refined = set.score(R, t, squared_threshold, best.score, &errors);
        if (!(refined < best.score)) break;
        const bool converged = refined > 0.99 * best.score;
        best.score = refined;
        best.R = R;
        best.t = t;
        set.squaredSampsonErrors(R, t, &errors);
        support = inlierPositions(errors, squared_threshold);
        if (converged) break;
      }
      const double inlier_share = static_cast<double>(support.size()) / set.size();
      needed = samplesNeeded(inlier_share, sample_size, options.success_probability);
    }
  }
  if (!best.success) return best;

  set.squaredSampsonErrors(best.R, best.t, &errors);
  for (int position : inlierPositions(errors, squared_threshold)) {
    best.inliers[set.indexAt(position)] = 1;
    ++best.inlier_count;
  }
  best.success = best.inlier_count >= options.min_inliers;
  return best;
}

}  // namespace multicam_egomotion
