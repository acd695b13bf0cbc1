// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "simulator/simulator.h"
#include "simulator/track_simulator.h"

namespace multicam_egomotion {
namespace {

SimulationOptions shortRun() {
  SimulationOptions options;
  options.duration_s = 2.0;
  return options;
}

TEST(SimulatorTracks, AreProjectionsOfTheirPointsWithTheNoiseAsked) {
  const Simulator simulator(makeScenario("handheld_stereo", shortRun()));
  TrackSimulationOptions options;
  options.pixel_sigma = 0.4;
  const SimulatedTracks tracks = simulateTracks(simulator.scenario(), options);
  ASSERT_EQ(static_cast<int>(tracks.frames.size()), simulator.frames());
  double sum = 0.0, bearing_sum = 0.0, worst = 0.0;
  int count = 0, shared = 0;
  for (int frame = 0; frame < simulator.frames(); ++frame) {
    const TrackedFrame& tracked = tracks.frames[frame];
    EXPECT_EQ(tracked.stamp_ns, simulator.frameStamp(frame));
    const Eigen::Isometry3d T_world_body = simulator.stateAtFrame(frame).T_world_body;
    std::map<TrackId, int> cameras;
    for (std::size_t i = 0; i < tracked.observations.size(); ++i) {
      const FeatureObservation& one = tracked.observations[i];
      if (i > 0) {
        const FeatureObservation& before = tracked.observations[i - 1];
        EXPECT_LT(std::make_pair(before.track, before.camera), std::make_pair(one.track, one.camera));
      }
      const RigCamera& camera = simulator.scenario().rig.camera(one.camera);
      const Eigen::Vector3d point = (T_world_body * camera.T_body_cam).inverse() * tracks.points.at(one.track);
      Eigen::Vector2d pixel;
      ASSERT_TRUE(camera.model.project(point, &pixel));
      EXPECT_NEAR(one.bearing.norm(), 1.0, 1e-12);
      // The pixel error as an estimator sees it.
      const Eigen::Vector2d error = one.to_pixel * (point / one.bearing.dot(point) - one.bearing);
      worst = std::max(worst, (error - (pixel - one.pixel)).norm());
      sum += (one.pixel - pixel).squaredNorm();
      bearing_sum += error.squaredNorm();
      ++count;
      shared += ++cameras[one.track] == 2;
    }
    EXPECT_GT(tracked.observations.size(), 250u);
  }
  EXPECT_LT(worst, 0.05);
  EXPECT_NEAR(std::sqrt(sum / (2 * count)), 0.4, 0.02);
  EXPECT_NEAR(std::sqrt(bearing_sum / (2 * count)), 0.4, 0.02);
  EXPECT_GT(shared, count / 4);
}

TEST(SimulatorTracks, LiveForManyFramesAndOutliersHaveTheirShare) {
  TrackSimulationOptions options;
  options.outlier_share = 0.2;
  options.cross_camera = false;
  const SimulatedTracks tracks = simulateTracks(makeScenario("car_surround", shortRun()), options);
  std::map<TrackId, std::set<int>> cameras;
  std::map<TrackId, int> length;
  int wrong = 0, count = 0;
  for (std::size_t frame = 0; frame < tracks.frames.size(); ++frame) {
    ASSERT_EQ(tracks.outlier[frame].size(), tracks.frames[frame].observations.size());
    for (std::size_t i = 0; i < tracks.outlier[frame].size(); ++i) {
      const FeatureObservation& one = tracks.frames[frame].observations[i];
      cameras[one.track].insert(one.camera);
      ++length[one.track];
      wrong += tracks.outlier[frame][i];
      ++count;
    }
  }
  double mean = 0.0;
  for (const auto& [id, seen] : cameras) {
    EXPECT_EQ(seen.size(), 1u);
    mean += length[id] / static_cast<double>(cameras.size());
  }
  EXPECT_GT(mean, 5.0);
  EXPECT_NEAR(wrong / static_cast<double>(count), 0.2, 0.02);
}

TEST(SimulatorTracks, AreTheSameForTheSameSeed) {
  const Scenario scenario = makeScenario("drone_fisheye", shortRun());
  const SimulatedTracks first = simulateTracks(scenario), second = simulateTracks(scenario);
  ASSERT_EQ(first.frames.size(), second.frames.size());
  for (std::size_t i = 0; i < first.frames.size(); ++i) {
    ASSERT_EQ(first.frames[i].observations.size(), second.frames[i].observations.size());
    for (std::size_t k = 0; k < first.frames[i].observations.size(); ++k) {
      EXPECT_EQ(first.frames[i].observations[k].pixel, second.frames[i].observations[k].pixel);
    }
  }
}

}  // namespace
}  // namespace multicam_egomotion
