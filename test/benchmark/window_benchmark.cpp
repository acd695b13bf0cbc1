// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
//
// window/add: one frame more in a full window.
#include <benchmark/benchmark.h>

#include <Eigen/Geometry>
#include <vector>

#include "../unit/bundle_scene.h"
#include "multicam_egomotion/odometry/window.h"

namespace multicam_egomotion {
namespace {

constexpr int kPoints = 200;

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

BENCHMARK(addToWindow)->Name("window/add");

}  // namespace
}  // namespace multicam_egomotion

BENCHMARK_MAIN();
