// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "multicam_egomotion/tracking/feature_tracker.h"
#include "multicam_egomotion/tracking/image_curvature.h"
#include "scaled_rig.h"
#include "simulator/simulator.h"

namespace multicam_egomotion {
namespace {

using Curvature = Eigen::Matrix<double, 2, 3>;

constexpr double kStep = 5.0;  // [px]

CameraModel radtan() { return {640, 480, 380.0, 379.0, 321.3, 238.2, Distortion::kRadtan, {-0.28, 0.07, 1e-4, 2e-4}}; }

Eigen::Vector3d squares(const Eigen::Vector2d& v) { return {v.x() * v.x(), v.x() * v.y(), v.y() * v.y()}; }

TEST(ImageCurvature, OfAPinholeIsThatOfTheFlatImage) {
  const double f = 300.0;
  const ImageCurvature curvature(CameraModel(640, 480, f, f, 320.0, 240.0, Distortion::kNone, {}), kStep);
  EXPECT_LT(curvature.at({320.0, 240.0}).cwiseAbs().maxCoeff(), 1e-9);
  // At tan(angle) = t from the axis the touching plane has x / (1 + t x / (f (1 + t^2))) where the image has x.
  const double t = 288.0 / f;
  EXPECT_NEAR(curvature.at({320.0 + 288.0, 240.0})(0, 0), -t / (f * (1.0 + t * t)), 1e-6);
}

TEST(ImageCurvature, IsThatOfASurfaceThatPassesBy) {
  // A surface parallel to the image moves across it.
  const CameraModel model = radtan();
  const ImageCurvature curvature(model, kStep);
  const Eigen::Vector2d from(60.0, 100.0);
  Eigen::Vector3d seen;
  ASSERT_TRUE(model.unproject(from, &seen));
  const Eigen::Vector3d moved = seen / seen.z() + Eigen::Vector3d(0.12, 0.03, 0.0);
  Eigen::Vector2d to;
  ASSERT_TRUE(model.project(moved, &to));
  const auto map = [&](const Eigen::Vector2d& offset) {
    Eigen::Vector3d bearing;
    Eigen::Vector2d pixel;
    EXPECT_TRUE(model.unproject(from + offset, &bearing));
    EXPECT_TRUE(model.project(bearing / bearing.z() + Eigen::Vector3d(0.12, 0.03, 0.0), &pixel));
    return pixel;
  };
  Eigen::Matrix2d linear;
  linear << 0.5 * (map({1, 0}) - map({-1, 0})), 0.5 * (map({0, 1}) - map({0, -1}));
  const Curvature found = patchCurvature(curvature.at(from), curvature.at(to), linear);
  Eigen::Vector2d with = Eigen::Vector2d::Zero(), without = with;  // mean difference over a patch
  int pixels = 0;
  for (int y = -7; y <= 7; ++y) {
    for (int x = -7; x <= 7; ++x, ++pixels) {
      const Eigen::Vector2d offset(x, y), affine = map(offset) - to - linear * offset;
      without += affine;
      with += affine - found * squares(offset);
    }
  }
  EXPECT_GT(without.norm() / pixels, 0.015);
  EXPECT_LT(with.norm(), 0.2 * without.norm());
}

// Features that come into a wide view at its edge, over the first frames.
TEST(ImageCurvature, LeavesNoBiasInTracks) {
  Scenario scenario = makeScenario("car_surround");
  scenario.rig = CameraRig({scaledRig(scenario.rig, 0.5).camera(1)});
  const Simulator simulator(scenario);
  const RigCamera& camera = scenario.rig.camera(0);
  std::vector<double> along;
  for (int first = 40; first < 160; first += 10) {
    FeatureTracker tracker(scenario.rig, FeatureTrackerOptions());
    const Eigen::Isometry3d then = simulator.stateAtFrame(first).T_world_body;
    const Eigen::Isometry3d now = simulator.stateAtFrame(first + 1).T_world_body;
    const TrackedFrame before =
        tracker.track(simulator.renderFrame(first, 2), Eigen::Isometry3d::Identity(), {camera.T_body_cam});
    const TrackedFrame after =
        tracker.track(simulator.renderFrame(first + 1, 2), then.inverse() * now, {camera.T_body_cam});
    for (const FeatureObservation& a : before.observations) {
      for (const FeatureObservation& b : after.observations) {
        if (a.track != b.track || std::abs(a.pixel.x() - 160.0) < 80.0) continue;
        const double distance = simulator.distance(0, then, a.pixel);
        Eigen::Vector2d expected;
        const Eigen::Isometry3d T_now_then = (now * camera.T_body_cam).inverse() * then * camera.T_body_cam;
        if (!camera.model.project(T_now_then * (distance * a.bearing), &expected)) continue;
        const Eigen::Vector2d flow = expected - a.pixel;
        const bool inwards = flow.x() * (160.0 - a.pixel.x()) > 0.0;
        if (inwards && flow.norm() > 5.0) along.push_back(flow.normalized().dot(b.pixel - expected));
      }
    }
  }
  ASSERT_GT(along.size(), 150u);
  std::nth_element(along.begin(), along.begin() + along.size() / 2, along.end());
  std::printf("median error along the flow %.4f px\n", along[along.size() / 2]);
  EXPECT_LT(std::abs(along[along.size() / 2]), 0.01);
}

}  // namespace
}  // namespace multicam_egomotion
