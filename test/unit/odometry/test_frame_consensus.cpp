// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "window_run.h"

namespace multicam_egomotion {
namespace {

struct Pair {
  PosedFrame first, second;
  Eigen::Isometry3d T_true;
  Eigen::Vector3d up;
  std::set<TrackId> outliers;  ///< of either frame
};

// Two successive frames, the second `seconds` into the scenario.
Pair pairOf(const std::string& name, double seconds, double outlier_share, int cameras = 0) {
  SimulationOptions simulation;
  simulation.image_rate_hz = name == "car_surround" ? 5.0 : 20.0;
  simulation.duration_s = seconds;
  simulation.cameras = cameras;
  const Scenario scenario = makeScenario(name, simulation);
  const Simulator simulator(scenario);
  const int frame = simulator.frames() - 1;
  TrackSimulationOptions options;
  options.tracks_per_camera = 100;
  options.outlier_share = outlier_share;
  const SimulatedTracks tracks = simulateTracks(scenario, options);
  Pair pair;
  pair.first = {tracks.frames[frame - 1], cameraPosesOf(scenario.rig)};
  pair.second = {tracks.frames[frame], cameraPosesOf(scenario.rig)};
  const Eigen::Isometry3d T_world_body = simulator.stateAtFrame(frame - 1).T_world_body;
  pair.T_true = T_world_body.inverse() * simulator.stateAtFrame(frame).T_world_body;
  pair.up = T_world_body.linear().transpose() * Eigen::Vector3d::UnitZ();
  for (int f : {frame - 1, frame}) {
    for (std::size_t k = 0; k < tracks.outlier[f].size(); ++k) {
      if (tracks.outlier[f][k]) pair.outliers.insert(tracks.frames[f].observations[k].track);
    }
  }
  return pair;
}

MotionSummary gyroscope(const Pair& pair, double sigma) {
  std::mt19937 random(4);
  WindowRunOptions options;
  options.rotation_sigma = sigma;
  return predictedMotion(pair.T_true, options, 0.05, &random);
}

FrameConsensus consensusOf(const Pair& pair, const MotionSummary& motion, const std::string& solver = "auto") {
  return findConsensus(pair.first, pair.second, motion, pair.up, solver, {}, 1);
}

double rotationError(const FrameConsensus& found, const Pair& pair) {
  return logSO3(found.T_previous_body.linear().transpose() * pair.T_true.linear()).norm();
}

TEST(FrameConsensus, AxisOnlyWhereTheAngleIsFarAboveItsError) {
  const Pair pair = pairOf("handheld_stereo", 0.75, 0.0);
  const double angle = logSO3(pair.T_true.linear()).norm();
  ASSERT_GT(angle, 0.01);
  EXPECT_EQ(consensusOf(pair, gyroscope(pair, angle / 60.0)).solver, "4pt-axis");
  EXPECT_EQ(consensusOf(pair, gyroscope(pair, angle / 10.0)).solver, "4pt-vertical");
  // A forced solver is used whatever the angle.
  EXPECT_EQ(consensusOf(pair, gyroscope(pair, angle / 10.0), "4pt-axis").solver, "4pt-axis");
  EXPECT_EQ(consensusOf(pair, gyroscope(pair, angle / 60.0), "4pt-vertical").solver, "4pt-vertical");
  // Without rotation there is no axis.
  const Pair straight = pairOf("straight_line", 0.75, 0.0);
  EXPECT_EQ(consensusOf(straight, gyroscope(straight, 3e-4)).solver, "4pt-vertical");
}

TEST(FrameConsensus, FindsTheMotionAndTheOutliers) {
  for (const char* name : {"handheld_stereo", "car_surround", "drone_fisheye"}) {
    for (const char* solver : {"auto", "4pt-vertical"}) {
      const Pair pair = pairOf(name, 2.6, 0.15);
      const FrameConsensus found = consensusOf(pair, gyroscope(pair, 3e-4), solver);
      ASSERT_TRUE(found.success) << name;
      EXPECT_LT(rotationError(found, pair), 0.003) << name << " " << solver;
      const std::set<TrackId> marked(found.outliers.begin(), found.outliers.end());
      EXPECT_EQ(marked.size(), found.outliers.size()) << "each track once";
      EXPECT_TRUE(std::is_sorted(found.outliers.begin(), found.outliers.end()));
      int missed = 0, wrong = 0;
      std::set<TrackId> shared;
      for (const auto& one : pair.first.frame.observations) shared.insert(one.track);
      for (TrackId id : pair.outliers) missed += shared.count(id) && !marked.count(id);
      for (TrackId id : marked) wrong += !pair.outliers.count(id);
      // An outlier along its epipolar line cannot be told.
      EXPECT_LT(missed, 0.3 * pair.outliers.size()) << name << " " << solver;
      EXPECT_LT(wrong, 0.05 * shared.size()) << name << " " << solver;
      EXPECT_GT(found.inliers, found.correspondences / 2);
    }
  }
}

TEST(FrameConsensus, OneCameraAloneHasAConsensusToo) {
  for (const char* name : {"handheld_stereo", "straight_line"}) {
    const Pair pair = pairOf(name, 1.0, 0.15, 1);
    const FrameConsensus found = consensusOf(pair, gyroscope(pair, 3e-4));
    ASSERT_TRUE(found.success) << name << ": " << found.correspondences << " correspondences, " << found.samples
                               << " samples";
    EXPECT_EQ(found.solver, "2pt-translation");
    EXPECT_LT(rotationError(found, pair), 0.003) << name;
    EXPECT_GT(found.inliers, found.correspondences / 2) << name;
  }
}

TEST(FrameConsensus, ParallaxIsTheImageMotionWithoutTheRotation) {
  const Pair moving = pairOf("straight_line", 1.0, 0.0);
  EXPECT_GT(consensusOf(moving, gyroscope(moving, 3e-4)).parallax_px, 1.5);
  const Pair standing = pairOf("creep", 0.25, 0.0);
  EXPECT_LT(consensusOf(standing, gyroscope(standing, 1e-5)).parallax_px, 0.8);
}

TEST(FrameConsensus, WithoutSharedTracksThereIsNone) {
  Pair pair = pairOf("handheld_stereo", 0.25, 0.0);
  for (FeatureObservation& one : pair.second.frame.observations) one.track += 1000000;
  const FrameConsensus found = consensusOf(pair, gyroscope(pair, 3e-4));
  EXPECT_FALSE(found.success);
  EXPECT_EQ(found.correspondences, 0);
  EXPECT_TRUE(found.outliers.empty());
  pair.second.frame.observations.clear();
  EXPECT_FALSE(consensusOf(pair, gyroscope(pair, 3e-4)).success);
}

TEST(FrameConsensus, WorksWithAWidePriorAsWithoutAnImu) {
  for (const char* name : {"handheld_stereo", "car_surround"}) {
    const Pair pair = pairOf(name, 2.6, 0.1);
    // The rate has changed by a degree an axis; what is said of it is three.
    MotionSummary constant_rate = gyroscope(pair, 0.0175);
    constant_rate.rotation_covariance = 0.0524 * 0.0524 * Eigen::Matrix3d::Identity();
    const FrameConsensus found = consensusOf(pair, constant_rate);
    ASSERT_TRUE(found.success) << name;
    EXPECT_EQ(found.solver, "4pt-vertical");
    // Two views confound a rotation with a small translation; the tracks are told apart all the same.
    EXPECT_LT(rotationError(found, pair), 0.04) << name;
    int wrong = 0;
    for (TrackId id : found.outliers) wrong += !pair.outliers.count(id);
    EXPECT_LT(wrong, 0.02 * found.correspondences) << name;
    EXPECT_GT(found.inliers, 0.7 * found.correspondences) << name;
  }
}

}  // namespace
}  // namespace multicam_egomotion
