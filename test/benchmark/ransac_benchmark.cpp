// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include <benchmark/benchmark.h>

#include <Eigen/Geometry>
#include <limits>
#include <numeric>
#include <random>
#include <string>
#include <vector>

#include "../unit/bundle_scene.h"
#include "../unit/correspondence_scene.h"
#include "multicam_egomotion/estimation/minimal_solvers.h"
#include "multicam_egomotion/estimation/robust_estimator.h"
#include "multicam_egomotion/odometry/window.h"

namespace multicam_egomotion {
namespace {

const Eigen::Vector3d kRotation(0.01, -0.02, 0.06);
const Eigen::Vector3d kTranslation(-0.5, 0.1, 0.04);
constexpr int kPoints = 200;  // seen by two cameras each: 400 correspondences

using Vertical = FourPointVertical;
using Axis = FourPointAxis;

CorrespondenceScene stereoScene(double outliers, unsigned seed) {
  return makeCorrespondenceScene(stereoShape(), kRotation, kTranslation, kPoints, 0.4, outliers, seed);
}

// One estimate a frame, over several frames, with the gyroscope's rotation as prior.
template <class Solver, class MakePrior>
void estimateFrames(benchmark::State& state, double outliers, const MakePrior& makePrior) {
  std::vector<CorrespondenceScene> scenes;
  std::vector<CorrespondenceSet> sets;
  for (unsigned seed = 1; seed <= 8; ++seed) {
    scenes.push_back(stereoScene(outliers, seed));
    sets.push_back(scenes.back().set());
  }
  std::size_t frame = 0;
  double samples = 0.0, models = 0.0, refinements = 0.0, good = 0.0;
  for (auto _ : state) {
    const CorrespondenceScene& scene = scenes[frame % scenes.size()];
    const Eigen::Matrix3d R = expSO3(Eigen::Vector3d(3e-4, -4e-4, 2e-4)) * scene.R;
    const RotationPrior prior{R, Eigen::Matrix3d::Identity() / (5e-4 * 5e-4)};
    const RobustEstimate found =
        estimate<Solver>(sets[frame % sets.size()], makePrior(R), prior, RobustEstimatorOptions(), frame);
    benchmark::DoNotOptimize(found.score);
    samples += found.samples;
    models += found.models;
    refinements += found.refinements;
    good += found.success && logSO3(found.R * scene.R.transpose()).norm() < 3e-3;
    ++frame;
  }
  state.counters["samples"] = samples / frame;
  state.counters["models"] = models / frame;
  state.counters["refinements"] = refinements / frame;
  state.counters["success"] = good / frame;
}

void score(benchmark::State& state) {
  const CorrespondenceScene scene = stereoScene(0.3, 1);
  const CorrespondenceSet set = scene.set();
  std::vector<double> buffer;
  for (auto _ : state) {
    benchmark::DoNotOptimize(set.score(scene.R, scene.t, 4.0, std::numeric_limits<double>::infinity(), &buffer));
  }
  state.counters["correspondences"] = set.size();
}

void refine(benchmark::State& state) {
  const CorrespondenceScene scene = stereoScene(0.0, 1);
  const CorrespondenceSet set = scene.set();
  std::vector<int> all(set.size());
  std::iota(all.begin(), all.end(), 0);
  for (auto _ : state) {
    Eigen::Matrix3d R = expSO3(Eigen::Vector3d(0.002, -0.002, 0.001)) * scene.R;
    Eigen::Vector3d t = scene.t + Eigen::Vector3d(0.01, 0.02, -0.01);
    benchmark::DoNotOptimize(refineTwoView(set, all, {}, {}, &R, &t));
  }
}

// A window of eight keyframes with 200 points seen by two cameras; one frame more.
void addToWindow(benchmark::State& state) {
  constexpr int kFrames = 14;
  const BundleScene scene = makeBundleScene(kFrames, kPoints, stereoCenters(), 0.4, 1);
  const std::vector<Eigen::Isometry3d> T_body_cam = [] {
    std::vector<Eigen::Isometry3d> poses;
    for (const Eigen::Vector3d& center : stereoCenters()) {
      poses.push_back(Eigen::Isometry3d(Eigen::Translation3d(center)));
    }
    return poses;
  }();
  const auto poseOf = [&](int i) {
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    T.linear() = scene.poses[i].R;
    T.translation() = scene.poses[i].p;
    return T;
  };
  std::vector<TrackedFrame> frames(kFrames);
  for (int l = 0; l < kPoints; ++l) {
    for (const BundleObservation& view : scene.bundle.landmarks[l].observations) {
      FeatureObservation feature;
      feature.track = l + 1;
      feature.camera = view.center == stereoCenters()[0] ? 0 : 1;
      feature.bearing = view.bearing;
      feature.to_pixel = view.to_pixel;
      frames[view.pose].observations.push_back(feature);
    }
  }
  Window window{WindowOptions()};
  window.start(0, poseOf(0), Matrix6d::Zero(), frames[0], T_body_cam);
  MotionSummary motion;
  const auto step = [&](int i) {
    motion.T_a_b = poseOf(i - 1).inverse() * poseOf(i);
    motion.rotation_covariance = 1e-7 * Eigen::Matrix3d::Identity();
    motion.translation_covariance = 1e-4 * Eigen::Matrix3d::Identity();
  };
  for (int i = 1; i + 1 < kFrames; ++i) {
    step(i);
    window.add(frames[i], T_body_cam, motion, {motion.T_a_b});
  }
  step(kFrames - 1);
  for (auto _ : state) {
    state.PauseTiming();
    Window copy = window;
    state.ResumeTiming();
    benchmark::DoNotOptimize(copy.add(frames[kFrames - 1], T_body_cam, motion, {motion.T_a_b}).ok);
  }
}

}  // namespace
}  // namespace multicam_egomotion

int main(int argc, char** argv) {
  using namespace multicam_egomotion;
  const auto vertical = [](const Eigen::Matrix3d& R) {
    return verticalPriorFromUp(Eigen::Vector3d::UnitZ(), R * Eigen::Vector3d::UnitZ());
  };
  const auto axis = [](const Eigen::Matrix3d& R) { return AxisPrior{logSO3(R)}; };
  for (int outliers : {0, 30, 60}) {
    const std::string share = "outliers:" + std::to_string(outliers);
    benchmark::RegisterBenchmark(("ransac/4pt-vertical/" + share).c_str(), [=](benchmark::State& state) {
      estimateFrames<Vertical>(state, 0.01 * outliers, vertical);
    });
    benchmark::RegisterBenchmark(("ransac/4pt-axis/" + share).c_str(),
                                 [=](benchmark::State& state) { estimateFrames<Axis>(state, 0.01 * outliers, axis); });
  }
  benchmark::RegisterBenchmark("ransac/score", score);
  benchmark::RegisterBenchmark("ransac/refine", refine);
  benchmark::RegisterBenchmark("window/add", addToWindow);
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
