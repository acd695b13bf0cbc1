// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <string>

#include "multicam_egomotion/geometry/covariance.h"
#include "multicam_egomotion/geometry/so3.h"
#include "multicam_egomotion/odometry/systematic_drift.h"
#include "scaled_rig.h"
#include "simulated_recording.h"

namespace multicam_egomotion {
namespace {

constexpr double kSigma = 0.02;

TEST(SystematicDrift, ATiltTurnsTheWholePath) {
  SystematicDrift drift;
  for (int i = 0; i <= 100; ++i) drift.follow(Eigen::Vector3d(5.0 + 0.1 * i, 0, 0), kSigma * kSigma);
  const Matrix6d covariance = drift.covariance();
  EXPECT_NEAR(std::sqrt(covariance(2, 2)), 10.0 * kSigma, 1e-9);
  EXPECT_NEAR(covariance(1, 1), 0.0, 1e-12);
  // A nose that points too low makes it end too low: rotation about y by +a takes x to -z.
  EXPECT_NEAR(covariance(2, 4), -10.0 * kSigma * kSigma, 1e-9);
  EXPECT_GT(symmetricEigenvalues(covariance)[0], -1e-12);
}

TEST(SystematicDrift, AWayThereAndBackComesHome) {
  SystematicDrift drift;
  for (const double x : {0.0, 3.0, 10.0, 3.0, 0.0}) drift.follow(Eigen::Vector3d(x, 0, 0), kSigma * kSigma);
  EXPECT_NEAR(drift.covariance()(2, 2), 0.0, 1e-9);
}

TEST(SystematicDrift, WhatTheTiltDidBeforeItWasKnownStays) {
  SystematicDrift drift;
  drift.follow(Eigen::Vector3d::Zero(), kSigma * kSigma);
  drift.follow(Eigen::Vector3d(1, 0, 0), 1e-4 * kSigma * kSigma);
  drift.follow(Eigen::Vector3d(100, 0, 0), 1e-4 * kSigma * kSigma);
  EXPECT_NEAR(std::sqrt(drift.covariance()(2, 2)), kSigma * std::sqrt(1 + 0.99 * 0.99 + 2 * 0.0099), 0.2 * kSigma);
  EXPECT_GT(symmetricEigenvalues(drift.covariance())[0], -1e-12);
}

TEST(SystematicDrift, APoorScaleAddsUp) {
  SystematicDrift drift;
  for (int i = 0; i <= 10; ++i) drift.follow(Eigen::Vector3d(i, 0, 0), 0.0, i > 5 ? 0.1 : 0.005);
  const double well = std::pow(5 * 0.005, 2), poor = std::pow(5 * 0.1, 2);
  EXPECT_NEAR(drift.covariance()(0, 0), well + poor + 2.0 * well, 1e-9);  // what was wrong before still is
}

// Mean of the accumulated position's NEES per degree of freedom from the first second on.
double accumulatedNees(const std::string& name, double seconds) {
  SimulationOptions options;
  options.duration_s = seconds;
  Scenario scenario = makeScenario(name, options);
  scenario.rig = scaledRig(scenario.rig, 0.5);  // which renders four times as fast
  const Simulator simulator(scenario);
  EgoMotion odometry(simulator.scenario().rig, simulator.scenario().imu, {});
  const Recording recording = recordingOf(simulator);
  const std::vector<EgoMotionResult> results = RecordingPlayer(recording).play(&odometry, 0, recording.frames);

  double sum = 0.0;
  Eigen::Vector3d last = Eigen::Vector3d::Zero(), sigma = Eigen::Vector3d::Zero();
  int count = 0;
  const Eigen::Isometry3d T_world_first = simulator.stateAt(results.front().stamp_ns).T_world_body;
  const Eigen::Isometry3d& T_odom_first = results.front().T_odom_body.pose;
  const Eigen::Matrix3d turn = T_odom_first.linear() * T_world_first.linear().transpose();
  const Eigen::Matrix3d yaw =
      expSO3(Eigen::Vector3d(0, 0, std::atan2(turn(1, 0) - turn(0, 1), turn(0, 0) + turn(1, 1))));
  for (const EgoMotionResult& result : results) {
    if (!result.has_pose || result.stamp_ns - results.front().stamp_ns < 1000000000) continue;
    const Eigen::Vector3d way =
        simulator.stateAt(result.stamp_ns).T_world_body.translation() - T_world_first.translation();
    const Eigen::Vector3d error = result.T_odom_body.pose.translation() - T_odom_first.translation() - yaw * way;
    const Eigen::Matrix3d covariance = result.T_odom_body.covariance.topLeftCorner<3, 3>();
    sum += squaredMahalanobis(error, covariance) / 3.0;
    ++count;
    last = error;
    sigma = covariance.diagonal().cwiseSqrt();
  }
  std::printf("%s: NEES %.2f; at the end error %.1f %.1f %.1f mm, sigma %.1f %.1f %.1f mm\n", name.c_str(), sum / count,
              1e3 * last.x(), 1e3 * last.y(), 1e3 * last.z(), 1e3 * sigma.x(), 1e3 * sigma.y(), 1e3 * sigma.z());
  return sum / count;
}

TEST(SystematicDrift, TheAccumulatedPositionIsAsCertainAsItSays) {
  double sum = 0.0;
  int count = 0;
  for (const auto& [name, seconds] : {std::pair("handheld_stereo", 2.0), std::pair("drone_fisheye", 1.5),
                                      std::pair("car_surround", 2.0), std::pair("straight_line", 1.5)}) {
    sum += accumulatedNees(name, seconds);
    ++count;
  }
  EXPECT_GT(sum / count, 0.3);
  EXPECT_LT(sum / count, 3.0);
}

}  // namespace
}  // namespace multicam_egomotion
