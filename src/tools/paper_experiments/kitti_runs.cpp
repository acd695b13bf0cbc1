// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "paper_experiments/kitti_runs.h"

#include <optional>

#include "multicam_egomotion/geometry/so3.h"
#include "multicam_egomotion/tracking/feature_tracker.h"
#include "paper_experiments/parallel.h"
#include "paper_experiments/track_odometry.h"

namespace multicam_egomotion {
namespace {

// As the odometry does it, without any prior: it predicts where features are and ends tracks that are outliers.
void trackImages(KittiSequence* sequence, std::uint64_t seed) {
  const std::vector<Eigen::Isometry3d> T_body_cam = sequence->cameraPoses();
  FeatureTracker tracker(sequence->rig, FeatureTrackerOptions());
  TrackOdometry odometry(T_body_cam, sequence->rig.camera(0).model.focalLength(), seed);
  forEachInParallel(sequence->folder.sequence + ": features", sequence->stamps_ns.size(), 1, [&](std::size_t i) {
    const MotionSummary predicted = odometry.predict(sequence->stamps_ns[i], std::nullopt);
    sequence->frames.push_back(tracker.track(kittiImages(*sequence, i), predicted.T_a_b, T_body_cam));
    const TrackOdometry::Step step = odometry.add(sequence->frames.back(), predicted);
    tracker.remove(step.outliers);
    if (step.keyframe) tracker.markKeyframe();
  });
}

constexpr double kNoRotation = 1e-6;  // what the digits of the poses resolve [rad]

SolverPriors priorsOf(const KittiSequence& sequence, std::size_t pair) {
  SolverPriors priors;
  priors.vertical = verticalPriorFromUp(sequence.up(pair), sequence.up(pair + 1));
  priors.axis.axis = logSO3(sequence.motion(pair).linear());
  priors.angle = priors.axis.axis.norm();
  if (priors.angle < kNoRotation) {
    priors.axis.axis.setZero();
    priors.angle = 0.0;
  }
  return priors;
}

std::vector<PairEstimate> runOurs(const KittiSequence& sequence, bool vertical, std::uint64_t seed) {
  TrackOdometry odometry(sequence.cameraPoses(), sequence.rig.camera(0).model.focalLength(), seed);
  std::vector<PairEstimate> estimates;
  for (std::size_t i = 0; i < sequence.frames.size(); ++i) {
    const auto up = vertical ? std::make_optional(sequence.up(i)) : std::nullopt;
    const MotionSummary predicted = odometry.predict(sequence.stamps_ns[i], up);
    const TrackOdometry::Step step = odometry.add(sequence.frames[i], predicted);
    if (i == 0) continue;
    estimates.push_back(
        {step.ok ? PairEstimate::State::kSolved : PairEstimate::State::kPredicted, step.T_previous_body.inverse()});
  }
  return estimates;
}

}  // namespace

std::vector<KittiRun> runKittiSequence(KittiSequence* sequence, const ExperimentOptions& options) {
  const std::uint64_t seed = options.seed;
  const int seeds = options.ransac_seeds;
  if (sequence->frames.empty()) trackImages(sequence, seed);
  const std::size_t pairs = sequence->frames.size() - 1;
  const std::vector<Eigen::Isometry3d> T_body_cam = sequence->cameraPoses();
  const std::vector<PaperSolver>& solvers = paperSolvers();
  std::vector<KittiRun> runs;
  for (const PaperSolver& solver : solvers) {
    runs.push_back({solver.name, std::vector<std::vector<PairEstimate>>(seeds, std::vector<PairEstimate>(pairs))});
  }
  forEachInParallel(sequence->folder.sequence + ": plain RANSAC", pairs, options.threads, [&](std::size_t pair) {
    const CorrespondenceSet set = matchTracks({sequence->frames[pair], T_body_cam, {}},
                                              {sequence->frames[pair + 1], T_body_cam, {}}, Eigen::Matrix3d::Identity())
                                      .set;
    const SolverPriors priors = priorsOf(*sequence, pair);
    for (std::size_t s = 0; s < solvers.size(); ++s) {
      for (int k = 0; k < seeds; ++k) {
        runs[s].estimates[k][pair] = plainRansac(set, solvers[s], priors, seed + k);
      }
    }
  });
  runs.push_back({"ours", std::vector<std::vector<PairEstimate>>(seeds)});
  runs.push_back({"ours-no-prior", std::vector<std::vector<PairEstimate>>(seeds)});
  forEachInParallel(sequence->folder.sequence + ": ours", 2 * seeds, options.threads, [&](std::size_t i) {
    const bool vertical = i < static_cast<std::size_t>(seeds);
    const std::size_t k = i % seeds;
    runs[solvers.size() + (vertical ? 0 : 1)].estimates[k] = runOurs(*sequence, vertical, seed + k);
  });
  return runs;
}

}  // namespace multicam_egomotion
