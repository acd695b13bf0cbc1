// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>

#include "multicam_egomotion/imu/imu_buffer.h"

namespace multicam_egomotion {
namespace {

ImuSample sampleAt(std::int64_t stamp_ns, double value) {
  ImuSample sample;
  sample.stamp_ns = stamp_ns;
  sample.angular_velocity.setConstant(value);
  sample.linear_acceleration.setConstant(-2 * value);
  return sample;
}

/// Samples every 5 ms from 1 s on whose rate is their time in milliseconds after 1 s.
ImuBuffer ramp(int count) {
  ImuBuffer buffer;
  for (int i = 0; i < count; ++i) {
    buffer.add(sampleAt(1000000000 + i * 5000000, 5.0 * i));
  }
  return buffer;
}

TEST(ImuBuffer, RefusesAndCountsUnusableSamples) {
  ImuBuffer buffer;
  EXPECT_TRUE(buffer.add(sampleAt(10, 1)));
  EXPECT_FALSE(buffer.add(sampleAt(10, 2)));
  EXPECT_FALSE(buffer.add(sampleAt(5, 2)));
  EXPECT_FALSE(buffer.add(sampleAt(0, 2)));
  EXPECT_FALSE(buffer.add(sampleAt(-7, 2)));
  EXPECT_FALSE(buffer.add(sampleAt(20, std::numeric_limits<double>::quiet_NaN())));
  EXPECT_FALSE(buffer.add(sampleAt(20, std::numeric_limits<double>::infinity())));
  EXPECT_FALSE(buffer.add(sampleAt(20, 1e30)));
  EXPECT_TRUE(buffer.add(sampleAt(20, 3)));
  EXPECT_EQ(buffer.size(), 2u);
  EXPECT_EQ(buffer.faults().duplicate, 1u);
  EXPECT_EQ(buffer.faults().out_of_order, 1u);
  EXPECT_EQ(buffer.faults().zero_stamp, 2u);
  EXPECT_EQ(buffer.faults().not_finite, 3u);
  EXPECT_EQ(buffer.faults().total(), 7u);
}

TEST(ImuBuffer, AFrozenSensorIsAGap) {
  ImuBuffer buffer = ramp(20);
  const std::int64_t last = buffer.latestStamp();
  for (int i = 1; i <= 100; ++i) EXPECT_EQ(buffer.add(sampleAt(last + i * 5000000, 95.0)), i == 1);
  EXPECT_EQ(buffer.faults().repeated, 99u);
  EXPECT_EQ(buffer.faults().total(), 0u);
  EXPECT_EQ(buffer.latestStamp(), last + 500000000);
  EXPECT_EQ(buffer.latestUsedStamp(), last + 5000000);
  std::vector<ImuSample> samples;
  EXPECT_FALSE(buffer.samplesBetween(last, last + 300000000, &samples));
  EXPECT_FALSE(buffer.add(sampleAt(last + 500000000, 1.0)));  // its stamp has been
  EXPECT_TRUE(buffer.add(sampleAt(last + 505000000, 1.0)));
  EXPECT_NEAR(buffer.spacingBefore(last + 400000000), 0.5, 1e-12);
}

TEST(ImuBuffer, RepetitionFromTheStartIsNoFault) {
  ImuBuffer slow_sensor, at_rest;
  for (int i = 0; i < 400; ++i) {
    EXPECT_TRUE(slow_sensor.add(sampleAt(1 + i * 5000000, i / 4)));
    EXPECT_TRUE(at_rest.add(sampleAt(1 + i * 5000000, i < 300 ? 0.0 : i)));
  }
  EXPECT_EQ(slow_sensor.faults().repeated, 0u);
  EXPECT_EQ(at_rest.faults().repeated, 0u);
}

TEST(ImuBuffer, TellsTheSpacingOfTheSamples) {
  ImuBuffer buffer = ramp(10);
  EXPECT_EQ(buffer.spacingBefore(1000000000), 0.0);
  EXPECT_NEAR(buffer.spacingBefore(1005000000), 0.005, 1e-12);
  EXPECT_NEAR(buffer.spacingBefore(1007000000), 0.005, 1e-12);
  EXPECT_NEAR(buffer.spacingBefore(1145000000), 0.1, 1e-12);  // past the end
  buffer.add(sampleAt(1345000000, 0));
  EXPECT_NEAR(buffer.spacingBefore(1145000000), 0.3, 1e-12);
}

TEST(ImuBuffer, InterpolatesBothEnds) {
  const ImuBuffer buffer = ramp(10);
  std::vector<ImuSample> samples;
  ASSERT_TRUE(buffer.samplesBetween(1007000000, 1018000000, &samples));
  ASSERT_EQ(samples.size(), 4u);
  const double expected[] = {7, 10, 15, 18};
  for (int i = 0; i < 4; ++i) {
    EXPECT_NEAR(samples[i].angular_velocity.x(), expected[i], 1e-9);
    EXPECT_NEAR(samples[i].linear_acceleration.z(), -2 * expected[i], 1e-9);
    EXPECT_EQ(samples[i].stamp_ns, 1000000000 + static_cast<std::int64_t>(expected[i]) * 1000000);
  }
}

TEST(ImuBuffer, GivesExactStampsOnce) {
  const ImuBuffer buffer = ramp(10);
  std::vector<ImuSample> samples;
  ASSERT_TRUE(buffer.samplesBetween(1005000000, 1015000000, &samples));
  ASSERT_EQ(samples.size(), 3u);
  EXPECT_EQ(samples.front().stamp_ns, 1005000000);
  EXPECT_EQ(samples.back().stamp_ns, 1015000000);
}

TEST(ImuBuffer, WorksBetweenTwoSamplesAndAtOneInstant) {
  const ImuBuffer buffer = ramp(10);
  std::vector<ImuSample> samples;
  ASSERT_TRUE(buffer.samplesBetween(1006000000, 1008000000, &samples));
  ASSERT_EQ(samples.size(), 2u);
  EXPECT_NEAR(samples[0].angular_velocity.x(), 6, 1e-9);
  EXPECT_NEAR(samples[1].angular_velocity.x(), 8, 1e-9);
  ASSERT_TRUE(buffer.samplesBetween(1006000000, 1006000000, &samples));
  ASSERT_EQ(samples.size(), 1u);
  EXPECT_NEAR(samples[0].angular_velocity.x(), 6, 1e-9);
}

TEST(ImuBuffer, GivesOnlyTheCoveredPart) {
  const ImuBuffer buffer = ramp(10);  // until 1.045 s
  std::vector<ImuSample> samples;
  EXPECT_FALSE(buffer.samplesBetween(990000000, 1007000000, &samples));
  ASSERT_EQ(samples.size(), 3u);
  EXPECT_EQ(samples.front().stamp_ns, 1000000000);
  EXPECT_FALSE(buffer.samplesBetween(1042000000, 1060000000, &samples));
  ASSERT_EQ(samples.size(), 2u);
  EXPECT_EQ(samples.back().stamp_ns, 1045000000);
  EXPECT_FALSE(buffer.samplesBetween(1050000000, 1060000000, &samples));
  EXPECT_TRUE(samples.empty());
  EXPECT_FALSE(buffer.samplesBetween(900000000, 950000000, &samples));
  EXPECT_TRUE(samples.empty());
  EXPECT_FALSE(ImuBuffer().samplesBetween(1, 2, &samples));
}

TEST(ImuBuffer, FindsTheLargestGap) {
  ImuBuffer buffer = ramp(3);  // until 1.010 s
  buffer.add(sampleAt(1050000000, 0));
  EXPECT_NEAR(buffer.largestGap(1000000000, 1050000000), 0.040, 1e-12);
  EXPECT_NEAR(buffer.largestGap(1000000000, 1010000000), 0.005, 1e-12);
  EXPECT_NEAR(buffer.largestGap(1000000000, 1150000000), 0.100, 1e-12);
  EXPECT_NEAR(buffer.largestGap(800000000, 1010000000), 0.200, 1e-12);
  EXPECT_NEAR(ImuBuffer().largestGap(0, 1000000000), 1.0, 1e-12);
}

TEST(ImuBuffer, IsBoundedAndPrunes) {
  EXPECT_THROW(ImuBuffer(1), std::invalid_argument);
  ImuBuffer buffer(4);
  for (int i = 1; i <= 10; ++i) {
    buffer.add(sampleAt(i * 100, i));
  }
  EXPECT_EQ(buffer.size(), 4u);
  EXPECT_EQ(buffer.oldestStamp(), 700);
  EXPECT_EQ(buffer.latestStamp(), 1000);
  buffer.prune(850);
  EXPECT_EQ(buffer.oldestStamp(), 800);  // still interpolates at 850
  buffer.prune(5000);
  EXPECT_EQ(buffer.size(), 1u);
  buffer.clear();
  EXPECT_TRUE(buffer.empty());
  EXPECT_EQ(buffer.latestStamp(), 0);
  EXPECT_TRUE(buffer.add(sampleAt(5, 1)));  // time may start anew
}

}  // namespace
}  // namespace multicam_egomotion
