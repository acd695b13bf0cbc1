// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause

#include <gtest/gtest.h>

#include <cmath>

#include "multicam_egomotion/geometry/so3.h"
#include "simulator/simulator.h"

namespace multicam_egomotion {
namespace {

class SimulatorMotion : public testing::TestWithParam<std::string> {};

TEST_P(SimulatorMotion, DerivativesAgreeWithDifferences) {
  const Trajectory trajectory = makeScenario(GetParam()).trajectory;
  const double h = 1e-4;
  for (double t = -0.45; t < 22.0; t += 0.173) {
    const BodyState before = trajectory.at(t - h), now = trajectory.at(t), after = trajectory.at(t + h);
    const Eigen::Matrix3d R = now.T_world_body.linear();
    const Eigen::Vector3d velocity = (after.T_world_body.translation() - before.T_world_body.translation()) / (2.0 * h);
    const Eigen::Vector3d rate =
        logSO3(before.T_world_body.linear().transpose() * after.T_world_body.linear()) / (2.0 * h);
    EXPECT_LT((R.transpose() * R - Eigen::Matrix3d::Identity()).norm(), 1e-12);
    EXPECT_LT((velocity - now.velocity).norm(), 1e-5) << t;
    EXPECT_LT(((after.velocity - before.velocity) / (2.0 * h) - now.acceleration).norm(), 1e-4) << t;
    EXPECT_LT((rate - now.angular_velocity).norm(), 1e-5) << t;
    EXPECT_LT(((after.angular_velocity - before.angular_velocity) / (2.0 * h) - now.angular_acceleration).norm(), 1e-4)
        << t;
  }
}

TEST_P(SimulatorMotion, ExactImuSamplesIntegrateToThePose) {
  SimulationOptions options;
  options.imu_noise_scale = 0.0;
  options.imu_rate_hz = 1000.0;
  options.duration_s = 3.0;
  const Simulator simulator(makeScenario(GetParam(), options));
  const std::vector<ImuSample> samples = simulator.imuSamples();
  const Eigen::Isometry3d T_body_imu = simulator.scenario().imu.T_body_imu;

  const BodyState start = simulator.stateAt(samples.front().stamp_ns);
  Eigen::Isometry3d T = start.T_world_body * T_body_imu;
  Eigen::Vector3d velocity =
      start.velocity +
      start.T_world_body.linear() * start.angular_velocity.cross(Eigen::Vector3d(T_body_imu.translation()));
  for (std::size_t i = 0; i + 1 < samples.size(); ++i) {
    const double dt = 1e-9 * static_cast<double>(samples[i + 1].stamp_ns - samples[i].stamp_ns);
    const Eigen::Matrix3d R = T.linear();
    const Eigen::Matrix3d R_next =
        R * expSO3(0.5 * dt * (samples[i].angular_velocity + samples[i + 1].angular_velocity));
    const Eigen::Vector3d acceleration =
        0.5 * (R * samples[i].linear_acceleration + R_next * samples[i + 1].linear_acceleration) -
        Eigen::Vector3d(0.0, 0.0, Simulator::kGravity);
    T.translation() += dt * velocity + 0.5 * dt * dt * acceleration;
    T.linear() = R_next;
    velocity += dt * acceleration;
  }
  const Eigen::Isometry3d truth = simulator.stateAt(samples.back().stamp_ns).T_world_body * T_body_imu;
  EXPECT_LT((T.translation() - truth.translation()).norm(), 1e-3);
  EXPECT_LT(logSO3(T.linear().transpose() * truth.linear()).norm(), 1e-4);
}

INSTANTIATE_TEST_SUITE_P(AllScenarios, SimulatorMotion, testing::ValuesIn(scenarioNames()),
                         [](const auto& info) { return info.param; });

TEST(SimulatorScenario, PathsAreAsLongAsPromised) {
  const auto path = [](const char* name) {
    const Scenario scenario = makeScenario(name);
    return scenario.trajectory.pathLength(0.0, scenario.options.duration_s);
  };
  EXPECT_GE(path("handheld_stereo"), 20.0);
  EXPECT_GE(path("drone_fisheye"), 20.0);
  EXPECT_GE(path("car_surround"), 50.0);
  EXPECT_GE(path("straight_line"), 20.0);
  EXPECT_NEAR(path("creep"), 0.2 * std::hypot(1.0, 0.2), 0.003);
}

TEST(SimulatorScenario, StopAndGoStandsStillForTenSeconds) {
  const Trajectory trajectory = makeScenario("stop_and_go").trajectory;
  const BodyState first = trajectory.at(6.001);
  for (double t = 6.001; t <= 16.0; t += 0.01) {
    const BodyState state = trajectory.at(t);
    ASSERT_EQ(state.T_world_body.matrix(), first.T_world_body.matrix()) << t;
    ASSERT_EQ(state.velocity.norm(), 0.0);
    ASSERT_EQ(state.angular_velocity.norm(), 0.0);
  }
  EXPECT_GT(trajectory.at(3.0).velocity.norm(), 1.0);
  EXPECT_GT(trajectory.at(18.0).velocity.norm(), 1.0);
}

TEST(SimulatorScenario, LoopClosesEveryMinute) {
  const Scenario scenario = makeScenario("loop");
  EXPECT_EQ(scenario.options.duration_s, 60.0);
  for (const double t : {0.0, 7.3, 31.0}) {
    const BodyState first = scenario.trajectory.at(t);
    for (const double later : {60.0, 3540.0}) {
      const BodyState again = scenario.trajectory.at(t + later);
      EXPECT_LT((first.T_world_body.matrix() - again.T_world_body.matrix()).norm(), 1e-9);
      EXPECT_LT((first.velocity - again.velocity).norm(), 1e-9);
      EXPECT_LT((first.acceleration - again.acceleration).norm(), 1e-8);
      EXPECT_LT((first.angular_velocity - again.angular_velocity).norm(), 1e-9);
    }
  }
}

TEST(SimulatorScenario, StraightLineNeverTurns) {
  const Trajectory trajectory = makeScenario("straight_line").trajectory;
  const BodyState first = trajectory.at(0.0);
  for (double t = 0.0; t < 15.0; t += 0.1) {
    const BodyState state = trajectory.at(t);
    EXPECT_EQ(state.angular_velocity.norm(), 0.0);
    EXPECT_LT(state.velocity.cross(first.velocity).norm(), 1e-12);
    EXPECT_GT(state.velocity.norm(), 0.5);
  }
}

TEST(SimulatorScenario, CarDrivesAlongItsHeading) {
  const Trajectory trajectory = makeScenario("car_surround").trajectory;
  EXPECT_EQ(trajectory.at(0.0).velocity.norm(), 0.0);
  double slowest = 1e9, fastest = 0.0;
  for (double t = 6.0; t < 60.0; t += 0.05) {
    const BodyState state = trajectory.at(t);
    const Eigen::Vector3d in_body = state.T_world_body.linear().transpose() * state.velocity;
    EXPECT_LT(std::abs(in_body.y()), 0.02 * in_body.x());
    slowest = std::min(slowest, in_body.x());
    fastest = std::max(fastest, in_body.x());
  }
  EXPECT_GT(slowest, 4.5);
  EXPECT_LT(fastest, 8.5);
}

TEST(SimulatorScenario, RefusesWhatCannotBe) {
  try {
    makeScenario("flying_carpet");
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("flying_carpet"), std::string::npos);
    EXPECT_NE(std::string(error.what()).find("car_surround"), std::string::npos);
  }
  SimulationOptions options;
  options.cameras = 3;
  EXPECT_THROW(makeScenario("creep", options), std::invalid_argument);
  options = {};
  options.duration_s = -1.0;
  EXPECT_THROW(makeScenario("creep", options), std::invalid_argument);
}

TEST(SimulatorImu, NoiseHasTheDensitiesOfTheCalibration) {
  SimulationOptions options;
  options.duration_s = 60.0;
  const Simulator simulator(makeScenario("straight_line", options));
  const ImuCalibration imu = simulator.scenario().imu;
  const Eigen::Matrix3d R_imu_body = imu.T_body_imu.linear().transpose();
  double gyroscope = 0.0, accelerometer = 0.0;
  const std::vector<SimulatedImu> samples = simulator.imu();
  for (const SimulatedImu& one : samples) {
    const BodyState state = simulator.stateAt(one.sample.stamp_ns);
    const Eigen::Vector3d force =
        state.T_world_body.linear().transpose() *
        (state.accelerationOf(imu.T_body_imu.translation()) + Eigen::Vector3d(0.0, 0.0, Simulator::kGravity));
    gyroscope += (one.sample.angular_velocity - one.gyroscope_bias).squaredNorm() / 3.0;
    accelerometer += (one.sample.linear_acceleration - R_imu_body * force - one.accelerometer_bias).squaredNorm() / 3.0;
  }
  const double count = static_cast<double>(samples.size());
  EXPECT_NEAR(std::sqrt(gyroscope / count / imu.rate_hz), imu.gyroscope_noise_density,
              0.03 * imu.gyroscope_noise_density);
  EXPECT_NEAR(std::sqrt(accelerometer / count / imu.rate_hz), imu.accelerometer_noise_density,
              0.03 * imu.accelerometer_noise_density);
  EXPECT_LE(samples.front().sample.stamp_ns, simulator.frameStamp(0) - 500000000);
  EXPECT_GE(samples.back().sample.stamp_ns, simulator.frameStamp(simulator.frames() - 1));
}

}  // namespace
}  // namespace multicam_egomotion
