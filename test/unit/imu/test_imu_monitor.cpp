// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <string>

#include "multicam_egomotion/imu/imu_monitor.h"

namespace multicam_egomotion {
namespace {

// What is said after three seconds of a moving IMU whose samples `change` has altered.
std::vector<std::string> faultsOf(const std::function<void(double t, ImuSample*)>& change, double rate_hz = 200.0) {
  ImuMonitor monitor(200.0, 9.81);
  std::mt19937 random(1);
  std::normal_distribution<double> noise(0.0, 0.01);
  for (int i = 0; i < 3 * rate_hz; ++i) {
    const double t = i / rate_hz;
    ImuSample sample;
    sample.stamp_ns = 1000000000 + static_cast<std::int64_t>(1e9 * t);
    sample.angular_velocity = {std::sin(t) + noise(random), noise(random), noise(random)};
    sample.linear_acceleration = {std::cos(3 * t) + noise(random), noise(random), 9.81 + noise(random)};
    change(t, &sample);
    monitor.add(sample);
  }
  return monitor.faults();
}

void expectOne(const std::vector<std::string>& faults, const std::string& text) {
  ASSERT_EQ(faults.size(), 1u);
  EXPECT_NE(faults[0].find(text), std::string::npos) << faults[0];
}

TEST(ImuMonitor, SaysNothingOfAGoodImu) {
  EXPECT_TRUE(faultsOf([](double, ImuSample*) {}).empty());
}

TEST(ImuMonitor, SaysNothingOfFreeFall) {
  EXPECT_TRUE(faultsOf([](double t, ImuSample* sample) {
                if (t > 1.0) sample->linear_acceleration.z() -= 9.81;
              }).empty());
}

TEST(ImuMonitor, NamesAccelerationInG) {
  expectOne(faultsOf([](double, ImuSample* sample) { sample->linear_acceleration /= 9.81; }), "in g?");
}

TEST(ImuMonitor, NamesValuesThatAreNotFinite) {
  expectOne(faultsOf([](double t, ImuSample* sample) {
              if (std::fmod(t, 0.1) < 0.004) sample->angular_velocity.y() = std::numeric_limits<double>::quiet_NaN();
            }),
            "not finite");
}

TEST(ImuMonitor, NamesFrozenValues) {
  expectOne(faultsOf([](double t, ImuSample* sample) {
              if (t < 1.0) return;
              sample->angular_velocity = {0.1, 0.2, 0.3};
              sample->linear_acceleration = {0.1, 0.2, 9.8};
            }),
            "frozen?");
}

TEST(ImuMonitor, NamesASaturatedChannel) {
  expectOne(faultsOf([](double, ImuSample* sample) {
              sample->angular_velocity.z() = std::min(4.36, 5.0 + sample->angular_velocity.z());
            }),
            "angular velocity z stays at 4.36");
}

TEST(ImuMonitor, NamesASlowImu) {
  expectOne(faultsOf([](double, ImuSample*) {}, 10.0), "expected 200 Hz");
}

TEST(ImuMonitor, ForgetsWhatIsOver) {
  EXPECT_TRUE(faultsOf([](double t, ImuSample* sample) {
                if (t < 1.0) sample->linear_acceleration /= 9.81;
              }).empty());
}

}  // namespace
}  // namespace multicam_egomotion
