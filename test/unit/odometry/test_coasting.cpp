// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "multicam_egomotion/odometry/coasting.h"

namespace multicam_egomotion {
namespace {

constexpr std::int64_t kPeriod = 50000000;  // [ns]
constexpr std::int64_t kStart = 1000 * kPeriod;

int ticksUntil(std::int64_t until_ns, Coasting* coasting) {
  int ticks = 0;
  while (const auto tick_ns = coasting->nextTick(until_ns)) {
    coasting->markTick(*tick_ns);
    ++ticks;
  }
  return ticks;
}

TEST(Coasting, NoTicksBeforeTheFirstFrame) {
  Coasting coasting(5.0);
  EXPECT_EQ(ticksUntil(kStart, &coasting), 0);
  coasting.markFrame(kStart, true);
  coasting.reset();
  EXPECT_EQ(ticksUntil(2 * kStart, &coasting), 0);
}

TEST(Coasting, TicksAtTheRateOfTheFramesUntilLost) {
  Coasting coasting(1.0);
  for (int i = 0; i < 5; ++i) coasting.markFrame(kStart + i * kPeriod, true);
  const std::int64_t last = kStart + 4 * kPeriod;
  EXPECT_FALSE(coasting.framesMissingBefore(last + kPeriod));
  EXPECT_FALSE(coasting.framesMissingBefore(last + 2 * kPeriod));  // one lost frame is no outage
  EXPECT_TRUE(coasting.framesMissingBefore(last + 3 * kPeriod));
  EXPECT_EQ(ticksUntil(last + 3 * kPeriod, &coasting), 3);
  EXPECT_TRUE(coasting.framesMissingBefore(last + 4 * kPeriod));
  EXPECT_EQ(coasting.status(last + 20 * kPeriod), EgoMotionStatus::kCoasting);
  EXPECT_EQ(coasting.status(last + 21 * kPeriod), EgoMotionStatus::kLost);
  EXPECT_EQ(ticksUntil(last + 1000 * kPeriod, &coasting), 18);  // the last of them says LOST
  EXPECT_TRUE(coasting.lost());
}

TEST(Coasting, FramesThatVisionCannotEstimateDoNotEndIt) {
  Coasting coasting(1.0);
  coasting.markFrame(kStart, true);
  for (int i = 1; i <= 25; ++i) coasting.markFrame(kStart + i * kPeriod, false);
  EXPECT_TRUE(coasting.lost());
  coasting.markFrame(kStart + 26 * kPeriod, true);
  EXPECT_FALSE(coasting.lost());
}

TEST(Coasting, TheRateIsThatOfTheShortestInterval) {
  Coasting coasting(5.0);
  for (const int frame : {0, 1, 2, 4, 5, 15}) coasting.markFrame(kStart + frame * kPeriod, true);
  EXPECT_EQ(coasting.period(), kPeriod);
  for (const int frame : {18, 21, 24, 27}) coasting.markFrame(kStart + frame * kPeriod, true);
  EXPECT_EQ(coasting.period(), 3 * kPeriod);  // the camera has become slower
}

TEST(Coasting, StampsThatNearlyAgreeAreNoRate) {
  Coasting coasting(1.0);
  coasting.markFrame(kStart, true);
  coasting.markFrame(kStart + 1, true);
  EXPECT_LE(ticksUntil(kStart + 20 * kPeriod, &coasting), 1001);
}

}  // namespace
}  // namespace multicam_egomotion
