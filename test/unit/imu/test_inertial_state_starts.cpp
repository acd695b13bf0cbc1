// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
// Starts and motions that are hard on the vertical, with vision replaced by noisy ground truth.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "inertial_replay.h"
#include "multicam_egomotion/geometry/covariance.h"
#include "simulator/simulator.h"

namespace multicam_egomotion {
namespace {

InertialRecording simulatedRecording(const std::string& name, double seconds) {
  SimulationOptions options;
  options.duration_s = seconds;
  options.cameras = 1;
  const Simulator simulator(makeScenario(name, options));
  InertialRecording recording;
  recording.calibration = simulator.scenario().imu;
  const Eigen::Isometry3d& T_body_imu = recording.calibration.T_body_imu;
  for (const SimulatedImu& one : simulator.imu()) {
    recording.imu.add(one.sample);
    const BodyState body = simulator.stateAt(one.sample.stamp_ns);
    const Eigen::Matrix3d R = body.T_world_body.linear();
    TruePose pose;
    pose.stamp_ns = one.sample.stamp_ns;
    pose.position = body.T_world_body * T_body_imu.translation();
    pose.velocity = body.velocity + R * body.angular_velocity.cross(T_body_imu.translation());
    pose.R_world_imu = R * T_body_imu.linear();
    recording.truth.push_back(pose);
  }
  return recording;
}

/// Any motion of the IMU, with noise and biases of a consumer IMU.
struct Motion {
  std::function<Eigen::Matrix3d(double)> attitude;
  std::function<Eigen::Vector3d(double)> position;
};

InertialRecording recordingOf(const Motion& motion, double seconds) {
  constexpr double kRate = 200, kStep = 1e-3;
  InertialRecording recording;
  std::mt19937 generator(5);
  std::normal_distribution<double> normal;
  const auto noise = [&](double sigma) {
    const double x = normal(generator), y = normal(generator), z = normal(generator);
    return Eigen::Vector3d(sigma * x, sigma * y, sigma * z);
  };
  const Eigen::Vector3d gyroscope_bias = noise(0.02), accelerometer_bias = noise(0.05);
  for (int i = 0; i < seconds * kRate; ++i) {
    const double t = i / kRate;
    const Eigen::Matrix3d R = motion.attitude(t);
    const Eigen::Vector3d before = motion.position(t - kStep), now = motion.position(t),
                          after = motion.position(t + kStep);
    TruePose pose;
    pose.stamp_ns = 1000000000 + std::llround(1e9 * t);
    pose.position = now;
    pose.velocity = (after - before) / (2 * kStep);
    pose.R_world_imu = R;
    ImuSample sample;
    sample.stamp_ns = pose.stamp_ns;
    sample.angular_velocity =
        logSO3(motion.attitude(t - kStep).transpose() * motion.attitude(t + kStep)) / (2 * kStep) + gyroscope_bias +
        noise(recording.calibration.gyroscope_noise_density * std::sqrt(kRate));
    sample.linear_acceleration =
        R.transpose() * ((after - 2 * now + before) / (kStep * kStep) + Eigen::Vector3d(0, 0, 9.81)) +
        accelerometer_bias + noise(recording.calibration.accelerometer_noise_density * std::sqrt(kRate));
    recording.imu.add(sample);
    recording.truth.push_back(pose);
  }
  return recording;
}

Eigen::Matrix3d swaying(double t) {
  return expSO3(Eigen::Vector3d(0, 0, 0.8 * std::sin(0.7 * t))) *
         expSO3(Eigen::Vector3d(0.3 * std::sin(1.7 * t + 1), 0.25 * std::sin(1.3 * t), 0));
}

Eigen::Vector3d drifting(double t) {
  return {1.5 * std::sin(0.9 * t), 1.2 * std::sin(1.2 * t + 0.3), 0.4 * std::sin(1.7 * t)};
}

void expectVertical(const InertialReplay& replay, double largest_deg, const std::string& what) {
  const double error = tiltError(replay.state(), replay.truth()).norm();
  EXPECT_LT(error, 3 * replay.state().tiltSigma()) << what;
  EXPECT_LT(error, largest_deg * kDegree) << what;
  std::printf("%s: tilt error %.2f deg, sigma %.2f deg\n", what.c_str(), error / kDegree,
              replay.state().tiltSigma() / kDegree);
}

TEST(InertialStateStarts, TwentyInMotionFindTheVerticalInTwoSeconds) {
  std::vector<InertialRecording> recordings;
  for (const char* name : {"V1_03", "MH_01"}) {
    InertialRecording recording = eurocRecording(name);
    if (!recording.truth.empty()) recordings.push_back(std::move(recording));
  }
  std::printf("%zu real recordings\n", recordings.size());
  for (const char* name : {"handheld_stereo", "drone_fisheye", "car_surround"}) {
    recordings.push_back(simulatedRecording(name, 20.0));
  }
  std::mt19937 generator(1);
  std::vector<double> errors;
  int within = 0;
  while (errors.size() < 20) {
    const InertialRecording& recording = recordings[errors.size() % recordings.size()];
    const double latest = static_cast<double>(recording.truth.size()) / 200 - 3;
    const double start = std::uniform_real_distribution<double>(0.5, latest)(generator);
    InertialReplay replay(recording, start, static_cast<int>(errors.size()) + 1);
    ASSERT_TRUE(replay.initialized());
    if (replay.state().startedStill()) continue;
    for (int frame = 0; frame < 40; ++frame) ASSERT_TRUE(replay.nextFrame());
    const double error = tiltError(replay.state(), replay.truth()).norm();
    within += error < 3 * replay.state().tiltSigma();
    std::printf("start at %5.1f s: tilt error %.2f deg, sigma %.2f deg\n", start, error / kDegree,
                replay.state().tiltSigma() / kDegree);
    errors.push_back(error / kDegree);
  }
  std::sort(errors.begin(), errors.end());
  EXPECT_LE(errors[10], 1.0);
  EXPECT_LE(errors.back(), 2.5);
  EXPECT_GE(within, 18);
  std::printf("median %.2f deg, worst %.2f deg, %d of 20 within 3 sigma\n", errors[10], errors.back(), within);
}

TEST(InertialStateStarts, TiltedAndUpsideDown) {
  for (const double roll_deg : {70.0, 110.0, 180.0}) {
    const Eigen::Matrix3d R = expSO3(Eigen::Vector3d(roll_deg * kDegree, 0, 0));
    const InertialRecording recording =
        recordingOf({[R](double t) { return Eigen::Matrix3d(swaying(t) * R); }, drifting}, 5);
    InertialReplay replay(recording, 0.5, 1);
    ASSERT_TRUE(replay.initialized());
    for (int frame = 0; frame < 40; ++frame) ASSERT_TRUE(replay.nextFrame());
    expectVertical(replay, 2.5, "roll " + std::to_string(std::lround(roll_deg)));
  }
}

TEST(InertialStateStarts, KeepsTheVerticalAt400DegPerSecond) {
  // About all three axes, there and back.
  const auto attitude = [](double t) {
    const double fast = t < 3 ? 0.0 : 400 * kDegree / 3.0 * std::sin(3.0 * (t - 3));
    return Eigen::Matrix3d(swaying(t) * expSO3(fast * Eigen::Vector3d(0.6, 0.64, 0.48)));
  };
  const InertialRecording recording = recordingOf({attitude, drifting}, 9);
  InertialReplay replay(recording, 0.5, 1);
  ASSERT_TRUE(replay.initialized());
  for (int frame = 0; frame < 160; ++frame) {
    ASSERT_TRUE(replay.nextFrame());
    const double error = tiltError(replay.state(), replay.truth()).norm();
    if (frame > 50) {
      ASSERT_LT(error, 3 * replay.state().tiltSigma()) << frame;
    }
  }
  EXPECT_EQ(replay.state().rotationCounts().recoveries, 0u);
  expectVertical(replay, 1.5, "400 deg/s");
}

TEST(InertialStateStarts, FreeFallShowsNoVerticalAndDoesNoHarm) {
  // Falls for a second from 4 s on, then is braked over a second.
  const auto position = [](double t) {
    Eigen::Vector3d p = drifting(t);
    const double fall = std::clamp(t - 4, 0.0, 1.0), brake = std::clamp(t - 5, 0.0, 1.0);
    const auto still = [](double s) { return -0.4 * std::sin(1.7 * s); };  // takes the vertical motion out
    p.z() += still(t) - 0.5 * 9.81 * (fall * fall + 2 * brake - brake * brake);
    p.head<2>() = drifting(std::min(t, 4.0)).head<2>() +
                  (t > 4 ? Eigen::Vector2d((t - 4) * (drifting(4.0) - drifting(3.999)).head<2>() / 0.001)
                         : Eigen::Vector2d::Zero());
    return p;
  };
  const InertialRecording recording = recordingOf({swaying, position}, 9);
  for (const bool seen : {true, false}) {  // by vision while it falls
    InertialReplay replay(recording, 0.5, 1);
    ASSERT_TRUE(replay.initialized());
    for (int frame = 0; frame < 130; ++frame) {
      const bool falls = frame >= 70 && frame < 90;
      ASSERT_TRUE(replay.nextFrame(seen || !falls));
      const double error = tiltError(replay.state(), replay.truth()).norm();
      const Eigen::Vector3d velocity = replay.truth().R_world_imu.transpose() * replay.truth().velocity;
      const Eigen::Vector3d off = replay.state().velocityInImuAxes() - velocity;
      if (frame > 40) {
        ASSERT_LT(error, 3 * replay.state().tiltSigma()) << frame;
        ASSERT_LT(squaredMahalanobis(off, replay.state().velocityCovarianceInImuAxes()), 25.0) << frame;
      }
    }
    expectVertical(replay, 1.5, seen ? "free fall" : "unseen free fall");
  }
}

}  // namespace
}  // namespace multicam_egomotion
