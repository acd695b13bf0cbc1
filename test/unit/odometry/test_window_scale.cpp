// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <limits>

#include "bundle_scene.h"
#include "multicam_egomotion/odometry/window_scale.h"

namespace multicam_egomotion {
namespace {

// Two cameras; every point is seen by one of them, or by both.
BundleScene twoCameraScene(bool overlap, unsigned seed) {
  BundleScene scene = makeBundleScene(6, 80, {{0.1, 0.4, 0.0}, {0.1, -0.4, 0.0}}, 0.3, seed);
  scene.bundle.pixel_sigma = 0.3;
  for (std::size_t l = 0; l < scene.bundle.landmarks.size(); ++l) {
    std::vector<BundleObservation> views;
    for (std::size_t i = 0; i < scene.bundle.landmarks[l].observations.size(); ++i) {
      views.push_back(scene.bundle.landmarks[l].observations[i]);
      views.back().camera = static_cast<int>(i % 2);
      if (!overlap && i % 2 != l % 2) views.pop_back();
    }
    scene.bundle.landmarks[l].observations = views;
  }
  return scene;
}

double pathOf(const std::vector<BundlePose>& poses) { return (poses.back().p - poses.front().p).norm(); }

// Starts at a share of the true scale.
BundleAdjustment shrunk(const BundleScene& scene, double share) {
  BundleAdjustment bundle = scene.bundle;
  for (BundlePose& pose : bundle.poses) pose.p = scene.poses[0].p + share * (pose.p - scene.poses[0].p);
  for (BundleLandmark& landmark : bundle.landmarks) landmark.inverse_distance /= share;
  return bundle;
}

TEST(WindowScale, IsFoundFromFarOffWithoutOverlap) {
  int lost = 0;
  for (unsigned seed = 1; seed <= 10; ++seed) {
    const BundleScene scene = twoCameraScene(false, seed);
    for (const double share : {0.05, 0.2, 5.0}) {
      BundleAdjustment bundle = shrunk(scene, share);
      const BundleOptions options;
      BundleSummary summary = bundle.solve(options);
      lost += std::abs(pathOf(bundle.poses) / pathOf(scene.poses) - 1.0) > 0.1;
      findScale(options, &bundle, &summary);
      EXPECT_NEAR(pathOf(bundle.poses) / pathOf(scene.poses), 1.0, 0.1) << "from " << share << ", seed " << seed;
    }
  }
  EXPECT_GT(lost, 5);  // the adjustment alone ends before
}

TEST(WindowScale, IsLeftToTheOverlap) {
  BundleAdjustment bundle = shrunk(twoCameraScene(true, 1), 0.2);
  const std::vector<BundlePose> before = bundle.poses;
  BundleSummary summary;
  summary.cost = std::numeric_limits<double>::infinity();  // any other scale would be taken
  findScale(BundleOptions(), &bundle, &summary);
  for (std::size_t i = 0; i < before.size(); ++i) EXPECT_EQ(bundle.poses[i].p, before[i].p);
}

}  // namespace
}  // namespace multicam_egomotion
