// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "paper_experiments/plain_ransac.h"

#include <algorithm>
#include <cmath>

#include "multicam_egomotion/estimation/minimal_sampler.h"
#include "multicam_egomotion/estimation/robust_estimator.h"

namespace multicam_egomotion {
namespace {

constexpr double kInlierThreshold = 1.0;  // Sampson error [px]

double samplesNeeded(double inlier_share, int sample_size, double success_probability) {
  const double all_inliers = std::pow(inlier_share, sample_size);
  return all_inliers >= 1.0 ? 1.0 : std::log1p(-success_probability) / std::log1p(-all_inliers);
}

}  // namespace

PairEstimate plainRansac(const CorrespondenceSet& set, const PaperSolver& solver, const SolverPriors& priors,
                         std::uint64_t seed) {
  const RobustEstimatorOptions options;
  SolverOptions solver_options;
  solver_options.positive_depths_only = true;
  solver_options.camera_centers = set.centers1().data();
  solver_options.camera_count = static_cast<int>(set.centers1().size());

  PairEstimate estimate;
  MinimalSampler sampler(set, Sampling::kUniform, solver.sample_size, options.max_samples, seed);
  std::array<int, kLargestSample> sample;
  std::array<RayCorrespondence, kLargestSample> rays;
  std::vector<RelativePose> solutions;
  CorrespondenceSet::Residuals residuals;
  long most = 0;
  int undefined = 0, samples = 0;
  double needed = options.max_samples;
  while (samples < options.max_samples && (samples < options.min_samples || samples < needed)) {
    if (!sampler.draw(sample.data())) break;
    ++samples;
    for (int i = 0; i < solver.sample_size; ++i) rays[i] = set.rays(sample[i]);
    undefined += solver.solve(rays.data(), priors, solver_options, &solutions) == SolverStatus::kAxisUndefined;
    for (const RelativePose& solution : solutions) {
      set.evaluate(solution.R, solution.t, kInlierThreshold, &residuals);
      const long inliers = std::count_if(residuals.errors.begin(), residuals.errors.end(),
                                         [](double error) { return error < kInlierThreshold; });
      if (inliers <= most) continue;
      most = inliers;
      estimate.state = PairEstimate::State::kSolved;
      estimate.T_f2_f1.linear() = solution.R;
      estimate.T_f2_f1.translation() = solution.t;
      needed =
          samplesNeeded(static_cast<double>(inliers) / set.size(), solver.sample_size, options.success_probability);
    }
  }
  if (samples > 0 && undefined == samples) estimate.state = PairEstimate::State::kUndefined;
  return estimate;
}

}  // namespace multicam_egomotion
