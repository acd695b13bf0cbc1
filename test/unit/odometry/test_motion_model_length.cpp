// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>

#include "inertial_run.h"

namespace multicam_egomotion {
namespace {

constexpr double kTooLong = 0.03, kLengthSigma = 0.05;

InertialStateOptions withLengthSigma(double sigma) {
  InertialStateOptions options;
  options.length_sigma = sigma;
  return options;
}

// A motion of the body as cameras see it that take the distances between them for too long: that of the first camera is
// too long.
Eigen::Isometry3d tooLong(Eigen::Isometry3d T, const Eigen::Vector3d& first_camera) {
  const Eigen::Vector3d arm = T.linear() * first_camera - first_camera;
  T.translation() = (1.0 + kTooLong) * (T.translation() + arm) - arm;
  return T;
}

void runTooLong(int frames, InertialRun* run) {
  ASSERT_TRUE(run->model_->initialize(run->simulator_.frameStamp(0)));
  for (int frame = 1; frame <= frames; ++frame) {
    run->model_->advanceTo(run->simulator_.frameStamp(frame));
    run->model_->correct(seen(tooLong(run->step(frame), run->firstCamera()), 5e-4, 3e-4), true);
    run->model_->markFrame();
  }
}

TEST(InertialMotionLength, IsLearntInLivelyMotion) {
  InertialRun run("handheld_stereo", 20.0, 1.0, withLengthSigma(kLengthSigma));
  EXPECT_EQ(*run.model_->lengthSigma(), kLengthSigma);
  runTooLong(400, &run);
  const double error = run.model_->lengthError(), sigma = *run.model_->lengthSigma();
  std::printf("lengths are too long by %.2f %% +- %.2f %%\n", 100.0 * error, 100.0 * sigma);
  EXPECT_NEAR(error, kTooLong, 3.0 * sigma);
  EXPECT_LT(sigma, 0.01);
}

TEST(InertialMotionLength, IsNotSeenAtConstantVelocity) {
  constexpr double kSpeed = 2.0;
  const auto stamp = [](int frame) { return std::int64_t{1000000000} + std::int64_t{50000000} * frame; };
  constexpr int kFirst = 10, kLast = 200;
  ImuBuffer buffer;
  for (std::int64_t ns = stamp(0); ns <= stamp(kLast + 1); ns += 5000000) {
    ImuSample sample;
    sample.stamp_ns = ns;
    sample.linear_acceleration << 0.0, 0.0, 9.81 + (ns % 10000000 == 0 ? 0.01 : -0.01);  // never twice the same
    buffer.add(sample);
  }
  InertialMotion model(ImuCalibration(), withLengthSigma(kLengthSigma), &buffer, false);
  ASSERT_TRUE(model.initialize(stamp(kFirst)));
  for (int frame = kFirst + 1; frame <= kLast; ++frame) {
    model.advanceTo(stamp(frame));
    model.correct(seen(motion({1.03 * kSpeed * 0.05, 0.0, 0.0}, Eigen::Vector3d::Zero()), 5e-4, 3e-4), true);
    model.markFrame();
  }
  EXPECT_NEAR(*model.lengthSigma(), kLengthSigma, 0.01 * kLengthSigma);
  EXPECT_NEAR(model.lengthError(), 0.0, 0.05 * kLengthSigma);
}

TEST(InertialMotionLength, IsNothingWhereLengthsAreKnown) {
  InertialRun run("handheld_stereo", 5.0, 1.0, withLengthSigma(0.0));
  runTooLong(100, &run);
  EXPECT_EQ(run.model_->lengthError(), 0.0);
  EXPECT_EQ(*run.model_->lengthSigma(), 0.0);
}

TEST(InertialMotionLength, ImagesAloneDoNotSeeIt) {
  const ConstantRateMotion model(0.05, 5.0);
  EXPECT_EQ(model.lengthError(), 0.0);
  EXPECT_FALSE(model.lengthSigma().has_value());
}

}  // namespace
}  // namespace multicam_egomotion
