// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "multicam_egomotion/estimation/robust_estimator.h"

#include <algorithm>
#include <cmath>

#include "multicam_egomotion/estimation/inlier_weights.h"
#include "multicam_egomotion/estimation/two_view_normal_equations.h"
#include "multicam_egomotion/geometry/so3.h"

namespace multicam_egomotion {
namespace {

using Part = CorrespondenceSet::Part;

constexpr double kLeastThreshold = 0.25;  // of the marginalizing score, as a share of the greatest
// Local optimization: first on the probe with a wide loss, as a minimal model is too crude to have all inliers within
// the threshold; then on everything.
constexpr double kProbeWidths[] = {4.0, 2.0};
constexpr int kFullSteps = 2;
constexpr int kLastRounds = 3;
constexpr double kLeastKept = 0.9;  // share of the inliers that a refinement keeps
constexpr double kDamping = 1e-3;
// A model is not scored further when its loss over the probe exceeds that of the best by more standard deviations than
// chance would give a model as good; the spread of a sum of n losses in [0, 1] is at most sqrt(n) / 2.
constexpr double kProbeSigmas = 2.0;
// A baseline that is short beside the longest may point either way, and local optimization does not lead from one to
// the other: then the next best minimal models are optimized as well.
constexpr double kDoubtfulBaseline = 0.25;
constexpr std::size_t kRunnersUp = 3;

struct Model {
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  Eigen::Vector3d t = Eigen::Vector3d::Zero();
  double score = std::numeric_limits<double>::infinity();
};

class Consensus {
 public:
  Consensus(const CorrespondenceSet& set, const MotionPriors& priors, const RobustEstimatorOptions& options)
      : set_(set),
        priors_(priors),
        options_(options),
        loss_{options.max_epipolar_error_px * (options.score == Score::kMsac ? 1.0 : kLeastThreshold),
              options.max_epipolar_error_px},
        probe_margin_(kProbeSigmas * 0.5 * std::sqrt(set.partSize(Part::kProbe))) {}

  bool contradictsPrior(const Eigen::Matrix3d& R) const {
    const RotationPrior& prior = priors_.rotation;
    if (prior.information.isZero(0.0)) return false;
    const Eigen::Vector3d difference = logSO3(R * prior.R.transpose());
    return difference.dot(prior.information * difference) > options_.max_rotation_sigmas * options_.max_rotation_sigmas;
  }

  /// Scores a minimal model, unless its probe is hopeless; true when it is the best of them.
  bool improves(Model* model) {
    const double probe = set_.sumOfLosses(model->R, model->t, loss_, Part::kProbe);
    if (probe > best_probe_ + probe_margin_) return false;
    model->score = probe + set_.sumOfLosses(model->R, model->t, loss_, Part::kRest);
    if (!(model->score < best_minimal_)) return false;
    best_minimal_ = model->score;
    best_probe_ = probe;
    return true;
  }

  Model optimizeLocally(const Model& minimal) const {
    Model model = minimal;
    for (double width : kProbeWidths) {
      if (!step(width, true, &model)) return minimal;
    }
    for (int i = 0; i < kFullSteps; ++i) {
      if (!step(1.0, false, &model)) return minimal;
    }
    model.score = set_.sumOfLosses(model.R, model.t, loss_, Part::kAll);
    return model.score < minimal.score ? model : minimal;
  }

 private:
  bool step(double width, bool probe_only, Model* model) const {
    const double limit = width * options_.max_epipolar_error_px;
    const TwoViewNoise noise{{0.5 * limit, limit}, options_.refinement.pixel_sigma * width};
    const auto equations = linearizeTwoView(set_.blocks(), probe_only, noise, priors_, model->R, model->t);
    const Eigen::Matrix<double, 6, 1> d = equations.step(kDamping);
    if (!d.allFinite()) return false;
    model->R = expSO3(d.tail<3>()) * model->R;
    model->t += d.head<3>();
    return true;
  }

  const CorrespondenceSet& set_;
  const MotionPriors& priors_;
  const RobustEstimatorOptions& options_;
  const RobustLoss loss_;
  const double probe_margin_;
  double best_minimal_ = std::numeric_limits<double>::infinity(), best_probe_ = best_minimal_;
};

bool hasShortBaseline(const CorrespondenceSet& set, const Model& model) {
  double least = std::numeric_limits<double>::infinity(), most = 0.0;
  for (const CorrespondenceSet::CameraPair& pair : set.cameraPairs()) {
    const double length = (model.R * pair.center1 + model.t - pair.center2).norm();
    least = std::min(least, length);
    most = std::max(most, length);
  }
  return least < kDoubtfulBaseline * most;
}

// Samples needed to draw one free of outliers with the probability wanted.
double samplesNeeded(double inlier_share, int sample_size, double success_probability) {
  const double all_inliers = std::pow(inlier_share, sample_size);
  if (all_inliers >= 1.0) return 1.0;
  return std::log1p(-success_probability) / std::log1p(-all_inliers);
}

int inliersOf(const CorrespondenceSet::Residuals& residuals, double limit) {
  return static_cast<int>(
      std::count_if(residuals.errors.begin(), residuals.errors.end(), [&](double e) { return e < limit; }));
}

// Last refinement, of which the first round may find the inliers farther away. Errors do not tell on which side of a
// baseline the points lie: where they leave its length open, as without motion, a step may turn it over and all its
// points come to lie behind the cameras. Such a step is not taken.
void refineLast(const CorrespondenceSet& set, const MotionPriors& priors, const RobustEstimatorOptions& options,
                RobustEstimate* result) {
  const double limit = options.max_epipolar_error_px;
  TwoViewEstimate estimate;
  estimate.R = result->R;
  estimate.t = result->t;
  CorrespondenceSet::Residuals residuals;
  std::vector<double> weights;
  set.evaluate(estimate.R, estimate.t, limit, &residuals);
  for (int round = 0; round < kLastRounds; ++round) {
    const int inliers = inliersOf(residuals, limit);
    if (round == 0) {
      weighInliers(residuals, 0.5 * limit, 2.0 * limit, &weights);
    } else {
      weighInliers(residuals, estimate.pixel_sigma, limit, &weights);
    }
    const RayBlocks<double> blocks = set.weightedBlocks(weights);
    TwoViewEstimate refined = refineTwoView(blocks, priors, options.refinement, limit, estimate);
    if (!refined.success) return;
    set.evaluate(refined.R, refined.t, limit, &residuals);
    const bool turned_over = inliersOf(residuals, limit) < kLeastKept * inliers;
    if (turned_over) {
      TwoViewRefinementOptions covariance_only = options.refinement;
      covariance_only.max_iterations = 0;
      refined = refineTwoView(blocks, priors, covariance_only, limit, estimate);
      if (!refined.success) return;
    }
    estimate = refined;
    if (turned_over) break;
  }
  result->R = estimate.R;
  result->t = estimate.t;
  result->covariance = estimate.covariance;
  result->pixel_sigma = estimate.pixel_sigma;
  result->scale = scaleObservability(estimate.t, estimate.covariance.topLeftCorner<3, 3>());
}

}  // namespace

RobustEstimate estimateRobustly(const CorrespondenceSet& set, int sample_size, const ModelGenerator& generate,
                                const MotionPriors& priors, const RobustEstimatorOptions& options, std::uint64_t seed) {
  RobustEstimate result;
  result.inliers.assign(set.size(), 0);
  if (set.size() < std::max(sample_size, options.min_inliers)) return result;

  const double limit = options.max_epipolar_error_px;
  MinimalSampler sampler(set, options.sampling, sample_size, options.max_samples, seed);
  Consensus consensus(set, priors, options);
  Model best;
  std::vector<int> sample(sample_size);
  std::vector<RelativePose> models;
  std::vector<Model> runners_up;
  CorrespondenceSet::Residuals residuals;
  double needed = options.max_samples;
  while (result.samples < options.max_samples && (result.samples < options.min_samples || result.samples < needed)) {
    ++result.samples;
    sampler.draw(sample.data());
    generate(sample.data(), &models);
    for (const RelativePose& candidate : models) {
      if (consensus.contradictsPrior(candidate.R)) continue;
      ++result.models;
      Model model{candidate.R, candidate.t};
      if (!consensus.improves(&model)) {
        if (std::isfinite(model.score)) runners_up.push_back(model);
        continue;
      }
      if (options.local_optimization) {
        model = consensus.optimizeLocally(model);
        ++result.refinements;
      }
      if (!(model.score < best.score)) continue;
      best = model;
      set.evaluate(best.R, best.t, limit, &residuals);
      const double share = static_cast<double>(inliersOf(residuals, limit)) / set.size();
      needed = samplesNeeded(share, sample_size, options.success_probability);
    }
  }
  if (!std::isfinite(best.score)) return result;
  if (options.local_optimization && hasShortBaseline(set, best)) {
    const auto end = runners_up.begin() + std::min(kRunnersUp, runners_up.size());
    std::partial_sort(runners_up.begin(), end, runners_up.end(),
                      [](const Model& a, const Model& b) { return a.score < b.score; });
    for (auto runner_up = runners_up.begin(); runner_up != end; ++runner_up) {
      const Model model = consensus.optimizeLocally(*runner_up);
      ++result.refinements;
      if (model.score < best.score) best = model;
    }
  }
  result.score = best.score;
  result.R = best.R;
  result.t = best.t;
  if (options.final_refinement) refineLast(set, priors, options, &result);
  set.evaluate(result.R, result.t, limit, &residuals);
  for (int i = 0; i < set.size(); ++i) {
    result.inliers[i] = residuals.errors[i] < limit;
    result.inlier_count += result.inliers[i];
  }
  result.success = result.inlier_count >= options.min_inliers;
  return result;
}

}  // namespace multicam_egomotion
