// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
// What may change between two frames.
#include <gtest/gtest.h>

#include <stdexcept>

#include "scaled_rig.h"
#include "simulated_recording.h"

namespace multicam_egomotion {
namespace {

constexpr int kFrames = 12;

TEST(EgoMotionTuning, TakesEffectAtTheNextFrame) {
  SimulationOptions simulation;
  simulation.duration_s = 0.05 * (kFrames - 1);
  Scenario scenario = makeScenario("handheld_stereo", simulation);
  scenario.rig = scaledRig(scenario.rig, 0.5);  // which renders four times as fast
  const Simulator simulator(scenario);
  const Recording recording = recordingOf(simulator);

  EgoMotionOptions options;
  EgoMotion odometry(simulator.scenario().rig, simulator.scenario().imu, options);
  RecordingPlayer player(recording);
  const std::vector<EgoMotionResult> before = player.play(&odometry, 0, 6);
  ASSERT_GT(before.back().features.size(), 200u);
  ASSERT_EQ(before.back().odom_epoch, 0u);

  options.solver = "8pt";
  EXPECT_THROW(odometry.tune(options), std::invalid_argument);
  EXPECT_EQ(odometry.options().solver, "auto");
  options.solver = "4pt-axis";
  options.tracker.features_per_camera = 0;
  EXPECT_THROW(odometry.tune(options), std::invalid_argument);
  EXPECT_EQ(odometry.options().solver, "auto");

  options.tracker.features_per_camera = 30;
  options.ransac.max_epipolar_error_px = 1.5;
  options.max_coast_s = 77.0;  // not while running
  odometry.tune(options);
  EXPECT_EQ(odometry.options().ransac.max_epipolar_error_px, 1.5);
  EXPECT_EQ(odometry.options().max_coast_s, EgoMotionOptions().max_coast_s);
  const std::vector<EgoMotionResult> after = player.play(&odometry, 6, kFrames);
  ASSERT_EQ(after.size(), 6u);
  for (const EgoMotionResult& result : after) {
    EXPECT_TRUE(result.has_relative_pose);
    EXPECT_EQ(result.solver, "4pt-axis");
    EXPECT_LE(result.features.size(), 2u * 2u * 30u);  // seen by both cameras at most
    EXPECT_GE(result.inliers, 20);
    EXPECT_EQ(result.odom_epoch, 0u);
  }
}

}  // namespace
}  // namespace multicam_egomotion
