// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <map>
#include <vector>

#include "camera_poses.h"
#include "multicam_egomotion/tracking/feature_tracker.h"
#include "scaled_rig.h"
#include "simulator/simulator.h"

namespace multicam_egomotion {
namespace {

/// A vehicle with four cameras that drives, and where its features are.
class Drive {
 public:
  static constexpr int kFirst = 60, kFrames = 9;

  Drive() : simulator_(scenario()) {
    for (int i = 0; i < kFrames; ++i) images_.push_back(simulator_.renderFrame(kFirst + i, 2));
  }

  const CameraRig& rig() const { return simulator_.scenario().rig; }
  const FrameSet& images(int i) const { return images_[i]; }
  Eigen::Isometry3d pose(int i) const { return simulator_.stateAtFrame(kFirst + i).T_world_body; }
  Eigen::Isometry3d motionTo(int i) const {
    return i == 0 ? Eigen::Isometry3d::Identity() : pose(i - 1).inverse() * pose(i);
  }
  Eigen::Vector3d point(int i, const FeatureObservation& seen) const {
    return pose(i) * rig().camera(seen.camera).T_body_cam *
           (simulator_.distance(seen.camera, pose(i), seen.pixel) * seen.bearing);
  }

 private:
  static Scenario scenario() {
    Scenario scenario = makeScenario("car_surround");
    scenario.rig = scaledRig(scenario.rig, 0.5);
    return scenario;
  }

  Simulator simulator_;
  std::vector<FrameSet> images_;
};

const Drive& drive() {
  static const Drive drive;
  return drive;
}

struct Passed {
  std::vector<double> errors;  ///< where another camera saw a feature than the first that did [px]
  int handed_over = 0;
};

/// `resume_every`: frames between the calls of resume(), 0: none. `stretch`: of the points given to it.
Passed run(int resume_every, double stretch = 1.0) {
  FeatureTracker tracker(drive().rig(), FeatureTrackerOptions());
  struct First {
    int camera;
    Eigen::Vector3d point;
  };
  std::map<TrackId, First> firsts;
  Passed passed;
  for (int i = 0; i < Drive::kFrames; ++i) {
    const TrackedFrame frame = tracker.track(drive().images(i), drive().motionTo(i), cameraPosesOf(drive().rig()));
    std::map<TrackId, First> unseen = firsts;
    for (const FeatureObservation& seen : frame.observations) {
      unseen.erase(seen.track);
      const auto [first, is_new] = firsts.insert({seen.track, {seen.camera, drive().point(i, seen)}});
      if (is_new || first->second.camera == seen.camera) continue;
      const RigCamera& camera = drive().rig().camera(seen.camera);
      Eigen::Vector2d expected;
      const Eigen::Isometry3d T_cam_world = (drive().pose(i) * camera.T_body_cam).inverse();
      if (!camera.model.project(T_cam_world * first->second.point, &expected)) continue;
      passed.errors.push_back((seen.pixel - expected).norm());
    }
    if (resume_every == 0 || i % resume_every != 0) continue;
    std::vector<TrackedPoint> points;
    for (const auto& [track, first] : unseen) {
      points.push_back({track, stretch * (drive().pose(i).inverse() * first.point)});
    }
    tracker.resume(points, drive().motionTo(i));
    passed.handed_over += tracker.counters().handed_over;
  }
  std::sort(passed.errors.begin(), passed.errors.end());
  return passed;
}

void expectRight(const Passed& passed) {
  ASSERT_GT(passed.errors.size(), 100u);
  const double median = passed.errors[passed.errors.size() / 2], most = passed.errors[passed.errors.size() * 3 / 4];
  std::printf("%d handed over; error median %.3f px, 75 %% below %.3f px\n", passed.handed_over, median, most);
  EXPECT_LT(median, 0.25);
  EXPECT_LT(most, 0.75);  // the rest lies at edges where the distance jumps
}

TEST(DepartedFeatures, GoOnInTheCameraThatSeesThemNext) { expectRight(run(1)); }

TEST(DepartedFeatures, AreFoundWhereTheyAreFromPointsThatAreRough) { expectRight(run(1, 1.1)); }

TEST(DepartedFeatures, AreNotLookedForWithoutTheirPoints) { EXPECT_EQ(run(0).errors.size(), 0u); }

TEST(DepartedFeatures, AreForgottenWhereTheMotionIsNotKnown) {
  // In most places several frames pass until the next camera sees a point.
  EXPECT_LT(run(2).handed_over, run(1).handed_over / 2);
}

}  // namespace
}  // namespace multicam_egomotion
