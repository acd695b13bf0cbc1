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

double pixelsPerRadian(const FeatureObservation& feature) { return feature.to_pixel.norm() / std::sqrt(2.0); }

double samplesNeeded(double inlier_share, int sample_size, double success_probability) {
  const double all_inliers = std::pow(inlier_share, sample_size);
  return all_inliers >= 1.0 ? 1.0 : std::log1p(-success_probability) / std::log1p(-all_inliers);
}

}  // namespace

CorrespondenceSet matchFrames(const TrackedFrame& first, const TrackedFrame& second,
                              const std::vector<Eigen::Isometry3d>& T_body_cam) {
  std::vector<CorrespondenceSet::Entry> entries;
  std::size_t begin = 0;
  for (const FeatureObservation& now : second.observations) {
    while (begin < first.observations.size() && first.observations[begin].track < now.track) ++begin;
    for (std::size_t i = begin; i < first.observations.size() && first.observations[i].track == now.track; ++i) {
      const FeatureObservation& then = first.observations[i];
      const Eigen::Isometry3d& T1 = T_body_cam[then.camera];
      const Eigen::Isometry3d& T2 = T_body_cam[now.camera];
      CorrespondenceSet::Entry entry;
      entry.rays = {makeRay(T1.linear() * then.bearing, T1.translation()),
                    makeRay(T2.linear() * now.bearing, T2.translation()), then.camera, now.camera};
      entry.pixels_per_radian1 = pixelsPerRadian(then);
      entry.pixels_per_radian2 = pixelsPerRadian(now);
      entries.push_back(entry);
    }
  }
  std::vector<Eigen::Vector3d> centers;
  for (const Eigen::Isometry3d& T : T_body_cam) centers.push_back(T.translation());
  return CorrespondenceSet(entries, centers, centers);
}

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
