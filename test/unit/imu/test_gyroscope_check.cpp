// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>

#include "multicam_egomotion/geometry/so3.h"
#include "multicam_egomotion/imu/gyroscope_check.h"
#include "multicam_egomotion/imu/gyroscope_integration.h"

namespace multicam_egomotion {
namespace {

constexpr double kImuRate = 200.0, kFrameRate = 20.0;
constexpr std::int64_t kStart = 1000000000;

struct Motion {
  Eigen::Vector3d amplitude = Eigen::Vector3d(0.6, 0.4, 0.8);  // [rad/s]
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();              // [rad/s]

  Eigen::Vector3d rate(double t) const {
    return mean + amplitude.cwiseProduct(Eigen::Vector3d(std::sin(3.0 * t), std::cos(2.2 * t), std::sin(1.7 * t + 1)));
  }
};

// `axes`: of the gyroscope's measurement; `offset`: t_imu = t_camera + offset.
GyroscopeCheck checked(const Motion& motion, const Eigen::Matrix3d& axes, double offset, double seconds,
                       const Eigen::Vector3d& bias = {0.02, -0.03, 0.01}) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  const auto noise = [&](double sigma) {
    const double x = normal(random), y = normal(random), z = normal(random);
    return Eigen::Vector3d(sigma * Eigen::Vector3d(x, y, z));
  };
  ImuBuffer truth, measured;
  for (int i = 0; i < (seconds + 1.0) * kImuRate; ++i) {
    ImuSample sample;
    sample.stamp_ns = kStart + static_cast<std::int64_t>(1e9 * i / kImuRate);
    sample.angular_velocity = motion.rate(i / kImuRate);
    truth.add(sample);
    sample.angular_velocity = axes * sample.angular_velocity + bias + noise(0.005);
    measured.add(sample);
  }
  GyroscopeCheck check;
  for (int i = 2; i < seconds * kFrameRate; ++i) {
    const std::int64_t stamp1 = kStart + static_cast<std::int64_t>(1e9 * i / kFrameRate);
    const std::int64_t stamp2 = kStart + static_cast<std::int64_t>(1e9 * (i + 1) / kFrameRate);
    const std::int64_t off = static_cast<std::int64_t>(1e9 * offset);
    const Eigen::Matrix3d R = integrateGyroscope(truth, stamp1 + off, stamp2 + off, Eigen::Vector3d::Zero(), 0.0).R_1_2;
    check.add(stamp1, stamp2, logSO3(R) + noise(3e-4), measured);
  }
  return check;
}

TEST(GyroscopeCheck, AgreesWithAGoodImuDespiteItsBias) {
  const GyroscopeCheck check = checked({}, Eigen::Matrix3d::Identity(), 0.0, 3.0);
  EXPECT_EQ(check.state(), GyroscopeCheck::State::kAgrees) << check.report();
  EXPECT_NEAR(check.offset(), 0.0, 0.002);
}

TEST(GyroscopeCheck, SaysWhileItCannotTell) {
  Motion slow;
  slow.amplitude *= 0.05;
  const GyroscopeCheck check = checked(slow, Eigen::Matrix3d::Identity(), 0.0, 3.0);
  EXPECT_EQ(check.state(), GyroscopeCheck::State::kNotCheckable);
  EXPECT_NE(check.report().find("not checkable yet"), std::string::npos);
}

TEST(GyroscopeCheck, NamesSwappedAxes) {
  Eigen::Matrix3d swapped;
  swapped << 0, 1, 0, 1, 0, 0, 0, 0, 1;
  const GyroscopeCheck check = checked({}, swapped, 0.0, 3.0);
  EXPECT_EQ(check.state(), GyroscopeCheck::State::kDisagrees);
  EXPECT_NE(check.report().find("x is y, y is x, z is z"), std::string::npos) << check.report();
}

TEST(GyroscopeCheck, NamesATurnedImu) {
  const GyroscopeCheck check = checked({}, expSO3(Eigen::Vector3d(0, 0, M_PI / 2)), 0.0, 3.0);
  EXPECT_NE(check.report().find("x is y, y is -x, z is z"), std::string::npos) << check.report();
}

TEST(GyroscopeCheck, MeasuresTheOffsetOfTheClocks) {
  for (const double offset : {-0.03, -0.008, 0.012, 0.04}) {
    const GyroscopeCheck check = checked({}, Eigen::Matrix3d::Identity(), offset, 3.0);
    EXPECT_NEAR(check.offset(), offset, 0.002);
    EXPECT_EQ(check.state(), GyroscopeCheck::State::kDisagrees) << offset;
    EXPECT_NE(check.report().find("clocks"), std::string::npos) << check.report();
  }
}

TEST(GyroscopeCheck, ASteadyTurnTellsNothingOfTheClocks) {
  Motion turn;
  turn.amplitude.setZero();
  turn.mean = {0, 0, 0.5};
  const GyroscopeCheck check = checked(turn, Eigen::Matrix3d::Identity(), 0.03, 5.0);
  EXPECT_EQ(check.state(), GyroscopeCheck::State::kAgrees) << check.report();
}

TEST(GyroscopeCheck, ATurnOfAVehicleShowsAWrongAxis) {
  Motion turn;
  turn.amplitude = {0.01, 0.01, 0.1};
  turn.mean = {0, 0, 0.5};
  const GyroscopeCheck check = checked(turn, -Eigen::Matrix3d::Identity(), 0.0, 5.0);
  EXPECT_EQ(check.state(), GyroscopeCheck::State::kDisagrees) << check.report();
}

}  // namespace
}  // namespace multicam_egomotion
