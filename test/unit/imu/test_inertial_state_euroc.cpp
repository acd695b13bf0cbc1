// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

#include "inertial_replay.h"

namespace multicam_egomotion {
namespace {

class InertialStateEuroc : public ::testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    recording_ = eurocRecording(GetParam());
    if (recording_.truth.empty()) {
      GTEST_SKIP() << "no recording " << eurocFolder(GetParam());
    }
  }

  InertialRecording recording_;
};

TEST_P(InertialStateEuroc, TiltIsAccurateAndItsCovarianceHonest) {
  for (const double start_s : {0.0, 20.0, 45.0, 70.0}) {
    double square_sum = 0, nees_sum = 0, largest_sigma = 0;
    int count = 0;
    for (int seed = 1; seed <= 5; ++seed) {
      InertialReplay replay(recording_, start_s, seed);
      ASSERT_TRUE(replay.initialized());
      const std::int64_t start = replay.truth().stamp_ns;
      while (replay.nextFrame()) {
        const double elapsed = 1e-9 * static_cast<double>(replay.truth().stamp_ns - start);
        const Eigen::Vector2d error = tiltError(replay.state(), replay.truth());
        if (elapsed > 3) {
          square_sum += error.squaredNorm();
          nees_sum += error.dot(replay.state().tiltCovariance().inverse() * error) / 2;
          ++count;
        }
        if (elapsed > 10) {
          largest_sigma = std::max(largest_sigma, replay.state().tiltSigma());
        }
      }
    }
    const std::string at = std::string(GetParam()) + " from " + std::to_string(start_s) + " s";
    EXPECT_LE(std::sqrt(square_sum / count) / kDegree, 0.6) << at;
    EXPECT_GE(nees_sum / count, 0.4) << at;
    EXPECT_LE(nees_sum / count, 2.5) << at;
    EXPECT_LE(largest_sigma / kDegree, 1.0) << at;
    std::printf("%s: tilt RMS %.3f deg, NEES %.2f, largest sigma after 10 s %.2f deg\n", at.c_str(),
                std::sqrt(square_sum / count) / kDegree, nees_sum / count, largest_sigma / kDegree);
  }
}

TEST_P(InertialStateEuroc, StartsHonestlyAtAnyTime) {
  const double duration = static_cast<double>(recording_.truth.size()) / 200;
  for (int start = 0; start < 10; ++start) {
    InertialReplay replay(recording_, start * (duration - 5) / 10, start + 1);
    ASSERT_TRUE(replay.initialized());
    std::printf("%s start %5.1f s: tilt error (sigma) [deg]", GetParam(), start * (duration - 5) / 10);
    for (int frame = 0; frame <= 60; ++frame) {
      const double error = tiltError(replay.state(), replay.truth()).norm();
      if (frame % 20 == 0) {
        EXPECT_LT(error, 3 * replay.state().tiltSigma()) << GetParam() << " start " << start << " frame " << frame;
        std::printf("  %ds %5.2f (%5.2f)", frame / 20, error / kDegree, replay.state().tiltSigma() / kDegree);
      }
      ASSERT_TRUE(replay.nextFrame());
    }
    std::printf("%s\n", replay.state().startedStill() ? "  still" : "");
  }
}

INSTANTIATE_TEST_SUITE_P(Recordings, InertialStateEuroc, ::testing::Values("V1_03", "MH_01"));

}  // namespace
}  // namespace multicam_egomotion
