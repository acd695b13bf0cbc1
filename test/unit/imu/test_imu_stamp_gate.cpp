// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "multicam_egomotion/imu/imu_stamp_gate.h"

namespace multicam_egomotion {
namespace {

constexpr std::int64_t kMs = 1000000;
constexpr std::int64_t kFirstStamp = 1000000 * kMs;

class ImuStampGateTest : public ::testing::Test {
 protected:
  // Stamps [ms] of what a sample lets pass.
  std::vector<int> pass(int stamp_ms) {
    ImuSample sample;
    sample.stamp_ns = kFirstStamp + stamp_ms * kMs;
    std::vector<int> stamps;
    for (const ImuSample& one : gate_.pass(sample))
      stamps.push_back(static_cast<int>((one.stamp_ns - kFirstStamp) / kMs));
    return stamps;
  }
  using Stamps = std::vector<int>;

  ImuStampGate gate_;
};

TEST_F(ImuStampGateTest, StampsInOrderAndALittleOutOfOrderPass) {
  for (const int stamp : {0, 5, 15, 10, 20, 20, 900, 850}) EXPECT_EQ(pass(stamp), Stamps{stamp});
  EXPECT_FALSE(gate_.jumpedBack());
  EXPECT_EQ(gate_.dropped(), 0u);
}

TEST_F(ImuStampGateTest, ASingleWrongStampIsDropped) {
  for (const int wrong : {100000, -100000, -300}) {
    EXPECT_EQ(pass(0), Stamps{0});
    EXPECT_TRUE(pass(wrong).empty());
    EXPECT_EQ(pass(5), Stamps{5});
    EXPECT_FALSE(gate_.jumpedBack());
  }
  EXPECT_EQ(gate_.dropped(), 3u);
}

TEST_F(ImuStampGateTest, TwoThatAgreeAreAJump) {
  EXPECT_EQ(pass(10000), Stamps{10000});
  EXPECT_TRUE(pass(9700).empty());
  EXPECT_EQ(pass(9705), (Stamps{9700, 9705}));
  EXPECT_TRUE(gate_.jumpedBack());
  EXPECT_EQ(pass(9710), Stamps{9710});
  EXPECT_FALSE(gate_.jumpedBack());
  EXPECT_TRUE(pass(20000).empty());
  EXPECT_EQ(pass(20005), (Stamps{20000, 20005}));
  EXPECT_FALSE(gate_.jumpedBack());
  EXPECT_EQ(gate_.dropped(), 0u);
}

TEST_F(ImuStampGateTest, ZeroStampsSayNothing) {
  pass(0);
  ImuSample zero;
  zero.stamp_ns = 0;
  EXPECT_EQ(gate_.pass(zero).size(), 1u);
  EXPECT_EQ(pass(5), Stamps{5});
}

}  // namespace
}  // namespace multicam_egomotion
