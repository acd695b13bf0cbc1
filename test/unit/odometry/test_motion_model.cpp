// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>

#include "inertial_run.h"
#include "multicam_egomotion/geometry/so3.h"
#include "multicam_egomotion/imu/imu_buffer.h"
#include "multicam_egomotion/odometry/learned_motion.h"

namespace multicam_egomotion {
namespace {

constexpr std::int64_t kFramePeriod = 50000000;
const Eigen::Isometry3d kMotion = motion({0.05, 0.01, -0.02}, {0.01, 0.02, 0.03});

TEST(MotionSummary, PoseCovarianceTurnsTheRotationIntoTheAxesOfTheFirst) {
  MotionSummary summary;
  summary.T_a_b = motion({1.0, 0.0, 0.0}, {0.4, -0.2, 0.7});
  summary.rotation_covariance = Eigen::Vector3d(1.0, 4.0, 9.0).asDiagonal();
  summary.translation_covariance = Eigen::Vector3d(2.0, 3.0, 5.0).asDiagonal();
  const Matrix6d covariance = poseCovariance(summary);
  const Eigen::Matrix3d& R = summary.T_a_b.linear();
  // d in R Exp(d) = Exp(R d) R.
  const Eigen::Matrix3d expected = R * summary.rotation_covariance * R.transpose();
  EXPECT_LT((covariance.bottomRightCorner<3, 3>() - expected).norm(), 1e-12);
  EXPECT_LT((covariance.topLeftCorner<3, 3>() - summary.translation_covariance).norm(), 1e-12);
}

TEST(ConstantRateMotion, StartsWithNothingKnown) {
  ConstantRateMotion model(0.0524, 5.0);
  EXPECT_FALSE(model.initialized());
  ASSERT_TRUE(model.initialize(1000));
  EXPECT_TRUE(model.initialized());
  model.advanceTo(1000 + kFramePeriod);
  const MotionSummary summary = model.motionSinceFrame();
  EXPECT_LT((summary.T_a_b.matrix() - Eigen::Matrix4d::Identity()).norm(), 1e-12);
  EXPECT_NEAR(std::sqrt(summary.rotation_covariance(0, 0)), 0.0524, 1e-9);
  EXPECT_NEAR(std::sqrt(summary.translation_covariance(1, 1)), 5.0 * 0.05, 0.05);
  EXPECT_EQ(model.up(), Eigen::Vector3d::UnitZ());
}

TEST(ConstantRateMotion, GoesOnAsBefore) {
  ConstantRateMotion model(0.0524, 5.0);
  std::int64_t now = 1000;
  model.initialize(now);
  for (int i = 0; i < 5; ++i) {
    model.advanceTo(now += kFramePeriod);
    model.correct(seen(kMotion, 1e-3, 1e-4), true);
    model.markFrame();
  }
  model.advanceTo(now += kFramePeriod);
  const MotionSummary summary = model.motionSinceFrame();
  EXPECT_LT(logSO3(summary.T_a_b.linear().transpose() * kMotion.linear()).norm(), 1e-9);
  // The velocity is constant in body axes now, so the displacement is off by the turn of one frame.
  EXPECT_LT((summary.T_a_b.translation() - kMotion.translation()).norm(), 0.05 * kMotion.translation().norm());
  EXPECT_LT(summary.translation_covariance.trace(), 3.0 * std::pow(0.05 * 0.3, 2));
  model.advanceTo(now += kFramePeriod);  // two frames ahead: twice as far
  EXPECT_NEAR(logSO3(model.motionSinceFrame().T_a_b.linear()).norm(), 2.0 * logSO3(kMotion.linear()).norm(), 1e-9);
}

TEST(ConstantRateMotion, CarriesTheVerticalWithVision) {
  ConstantRateMotion model(0.0524, 5.0);
  std::int64_t now = 1000;
  model.initialize(now);
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();  // body now in body at the start
  for (int i = 0; i < 50; ++i) {
    const Eigen::Vector3d before = model.up();
    model.advanceTo(now += kFramePeriod);
    model.correct(seen(kMotion, 1e-3, 1e-4), true);
    EXPECT_EQ(model.upAtFrame(), before);
    model.markFrame();
    R = R * kMotion.linear();
    EXPECT_LT((model.up() - R.transpose() * Eigen::Vector3d::UnitZ()).norm(), 1e-9);
  }
}

// A length that is hardly seen must not erase what is known of the speed: one such frame would let the pose jump.
TEST(ConstantRateMotion, AWeakLengthKeepsTheSpeed) {
  ConstantRateMotion model(0.0524, 5.0);
  std::int64_t now = 1000;
  model.initialize(now);
  const auto see = [&](const Eigen::Vector3d& p, double sigma) {
    model.advanceTo(now += kFramePeriod);
    model.correct(seen(motion(p, Eigen::Vector3d::Zero()), sigma, 1e-4), true);
    model.markFrame();
  };
  for (int i = 0; i < 20; ++i) see({0.1, 0.0, 0.0}, 1e-3);
  EXPECT_NEAR(model.twist().linear.x(), 2.0, 0.01);
  const double sigma = std::sqrt(model.twist().covariance(0, 0));
  see({7.0, 0.0, 0.0}, 5.0);
  EXPECT_NEAR(model.twist().linear.x(), 2.0, 0.05);
  // It has grown by what the acceleration may have changed, not to what vision says.
  EXPECT_LT(std::sqrt(model.twist().covariance(0, 0)), std::hypot(sigma, 3.0 * kFramePeriod * 1e-9) + 1e-6);
  // A length that is seen well decides again.
  see({0.2, 0.0, 0.0}, 1e-3);
  EXPECT_GT(model.twist().linear.x(), 2.5);
}

TEST(ConstantRateMotion, WithoutScaleTheSpeedStaysAndTheDirectionIsVisions) {
  ConstantRateMotion model(0.0524, 5.0);
  std::int64_t now = 1000;
  model.initialize(now);
  model.advanceTo(now += kFramePeriod);
  model.correct(seen(motion({0.1, 0.0, 0.0}, Eigen::Vector3d::Zero()), 1e-3, 1e-4), true);
  model.markFrame();
  const double speed = model.twist().linear.norm(), sigma = std::sqrt(model.twist().covariance(0, 0));
  EXPECT_NEAR(speed, 2.0, 0.01);  // the prior of the velocity counts too
  double last = sigma;
  for (int i = 0; i < 100; ++i) {
    model.advanceTo(now += kFramePeriod);
    model.correct(seen(motion({0.0, 7.0, 0.0}, Eigen::Vector3d::Zero()), 1e-3, 1e-4), false);
    model.markFrame();
    EXPECT_NEAR(model.twist().linear.norm(), speed, 1e-9);
    EXPECT_NEAR(model.twist().linear.y(), speed, 1e-9);
    EXPECT_GE(std::sqrt(model.twist().covariance(0, 0)), last - 1e-12);
    last = std::sqrt(model.twist().covariance(0, 0));
  }
  EXPECT_GT(last, sigma);
  EXPECT_LE(last, 5.0 + 1e-9);
}

TEST(ConstantRateMotion, ResetAndRestart) {
  ConstantRateMotion model(0.0524, 5.0);
  model.initialize(1000);
  model.advanceTo(1000 + kFramePeriod);
  model.correct(seen(kMotion, 1e-3, 1e-4), true);
  const Eigen::Vector3d up = model.up();
  model.restartAt(500, 0.17);
  EXPECT_TRUE(model.initialized());
  EXPECT_EQ(model.stamp(), 500);
  EXPECT_EQ(model.up(), up);
  EXPECT_EQ(model.twist().linear.norm(), 0.0);
  EXPECT_NEAR(std::sqrt(model.twist().covariance(0, 0)), 5.0, 1e-9);
  model.reset(false);
  EXPECT_FALSE(model.initialized());
  EXPECT_EQ(model.up(), Eigen::Vector3d::UnitZ());
}

TEST(LearnedMotion, APoorlyKnownScaleLeavesTheLengthOpen) {
  WindowEstimate estimate;
  estimate.vision = seen(motion({0.0, 0.5, 0.0}, Eigen::Vector3d::Zero()), 1e-3, 1e-4);
  estimate.scale_state = ScaleState::kObservable;
  const auto sigma = [&](double scale_noise, int axis) {
    estimate.scale_noise = scale_noise;
    const LearnedMotion learned = learnedMotion(estimate, Eigen::Vector3d::Zero(), true, 5.0, 400.0);
    EXPECT_TRUE(learned.use_displacement);
    EXPECT_EQ(learned.vision.T_a_b.translation().y(), 0.5);
    return std::sqrt(learned.vision.covariance(axis, axis));
  };
  // As well known along the motion as across: noise, another in each frame.
  EXPECT_NEAR(sigma(0.002, 1), 1e-3, 1e-9);
  // The scale is worse: the error lasts.
  EXPECT_GT(sigma(0.05, 1), 5.0 * 0.05 * 0.5);
  EXPECT_NEAR(sigma(0.05, 0), 1e-3, 1e-9);
}

TEST(InertialMotion, NeedsSamplesToStart) {
  ImuBuffer buffer;
  InertialMotion model(ImuCalibration(), {}, &buffer, false);
  EXPECT_FALSE(model.initialize(1000000000));
  EXPECT_FALSE(model.initialized());
}

TEST(InertialMotion, PredictsTheMotionOfTheBody) {
  // The IMU is off the body's origin and turned against it.
  InertialRun run("handheld_stereo", 4.0, 0.01);
  ASSERT_TRUE(run.model_->initialize(run.simulator_.frameStamp(0)));
  EXPECT_EQ(run.model_->stamp(), run.simulator_.frameStamp(0));
  run.run(1, 79, true, true);
  run.model_->markFrame();
  run.model_->advanceTo(run.simulator_.frameStamp(80));
  const MotionSummary summary = run.model_->motionSinceFrame();
  const Eigen::Isometry3d T = run.step(80);
  EXPECT_LT(logSO3(summary.T_a_b.linear().transpose() * T.linear()).norm(), 2e-3);
  EXPECT_LT((summary.T_a_b.translation() - T.translation()).norm(), 5e-3);
  const BodyState state = run.simulator_.stateAtFrame(80);
  const TwistWithCovariance twist = run.model_->twist();
  EXPECT_LT((twist.linear - state.T_world_body.linear().transpose() * state.velocity).norm(), 0.08);
  EXPECT_LT((twist.angular - state.angular_velocity).norm(), 0.03);
}

TEST(InertialMotion, LearnsBiasesAndTheVerticalFromVision) {
  InertialRun run("handheld_stereo", 8.0, 1.0);
  ASSERT_TRUE(run.model_->initialize(run.simulator_.frameStamp(0)));
  const double before = run.model_->tiltSigma();
  run.run(1, 160, true, true);
  EXPECT_LT(run.tiltError(160), 0.02);
  EXPECT_LT(run.model_->tiltSigma(), before);
  EXPECT_LT((run.model_->gyroscopeBias() - run.imu_.back().gyroscope_bias).norm(), 0.003);
}

TEST(InertialMotion, CovariancesCoverTheErrors) {
  // Rotation and displacement between frames over the run, in units of their sigmas.
  double rotation = 0.0, displacement = 0.0;
  int count = 0;
  InertialRun run("handheld_stereo", 6.0, 1.0);
  ASSERT_TRUE(run.model_->initialize(run.simulator_.frameStamp(0)));
  for (int frame = 1; frame <= 120; ++frame) {
    run.model_->advanceTo(run.simulator_.frameStamp(frame));
    const MotionSummary summary = run.model_->motionSinceFrame();
    const Eigen::Isometry3d T = run.step(frame);
    if (frame > 20) {
      const Eigen::Vector3d r = logSO3(summary.T_a_b.linear().transpose() * T.linear());
      const Eigen::Vector3d p = T.translation() - summary.T_a_b.translation();
      rotation += r.dot(summary.rotation_covariance.inverse() * r) / 3.0;
      displacement += p.dot(summary.translation_covariance.inverse() * p) / 3.0;
      ++count;
    }
    run.model_->correct(seen(T, 5e-4, 3e-4), true);
    run.model_->markFrame();
  }
  // The model allows for errors of scale that the simulated IMU has not, so it may be cautious but not confident.
  EXPECT_LT(rotation / count, 2.0);
  EXPECT_LT(displacement / count, 2.0);
  EXPECT_GT(rotation / count, 0.005);
  EXPECT_GT(displacement / count, 0.0005);
}

TEST(InertialMotion, WithoutScaleTheVelocityIsNotLearned) {
  InertialRun with("straight_line", 2.0, 1.0), without("straight_line", 2.0, 1.0);
  for (InertialRun* run : {&with, &without}) {
    ASSERT_TRUE(run->model_->initialize(run->simulator_.frameStamp(0)));
    run->run(1, 20, true, run == &with);
  }
  EXPECT_LT(std::sqrt(with.model_->twist().covariance(0, 0)), 0.3);
  EXPECT_GT(std::sqrt(without.model_->twist().covariance(0, 0)), 1.0);
}

TEST(InertialMotion, ResetKeepsBiasesUnlessTold) {
  InertialRun run("handheld_stereo", 4.0, 1.0);
  ASSERT_TRUE(run.model_->initialize(run.simulator_.frameStamp(0)));
  run.run(1, 60, true, true);
  const Eigen::Vector3d bias = run.model_->gyroscopeBias();
  EXPECT_GT(bias.norm(), 1e-4);
  run.model_->reset(false);
  EXPECT_FALSE(run.model_->initialized());
  ASSERT_TRUE(run.model_->initialize(run.simulator_.frameStamp(61)));
  EXPECT_LT((run.model_->gyroscopeBias() - bias).norm(), 1e-9);
  run.model_->reset(true);
  ASSERT_TRUE(run.model_->initialize(run.simulator_.frameStamp(62)));
  EXPECT_LT(run.model_->gyroscopeBias().norm(), 1e-9);
}

TEST(InertialMotion, RestartGoesOnAtAnotherTime) {
  InertialRun run("handheld_stereo", 4.0, 1.0);
  ASSERT_TRUE(run.model_->initialize(run.simulator_.frameStamp(0)));
  run.run(1, 60, true, true);
  const Eigen::Vector3d up = run.model_->up(), bias = run.model_->gyroscopeBias();
  run.model_->restartAt(run.simulator_.frameStamp(10), 0.17);
  EXPECT_TRUE(run.model_->initialized());
  EXPECT_EQ(run.model_->stamp(), run.simulator_.frameStamp(10));
  EXPECT_LT((run.model_->up() - up).norm(), 1e-9);
  EXPECT_EQ(run.model_->gyroscopeBias(), bias);
  EXPECT_GT(run.model_->tiltSigma(), 0.16);
}

TEST(InertialMotion, AStartInACurveFindsTheVertical) {
  // A car at 6 m/s in a circle of 12 m: the force is 17 deg off the vertical.
  constexpr double kRate = 0.5, kSpeed = 6.0;
  const auto pose = [](int frame) {
    const double turned = 0.1 * frame * kRate;
    return motion(kSpeed / kRate * Eigen::Vector3d(std::sin(turned), 1.0 - std::cos(turned), 0.0), {0.0, 0.0, turned});
  };
  const auto stamp = [](int frame) { return std::int64_t{1000000000} + std::int64_t{100000000} * frame; };
  ImuBuffer buffer;
  for (std::int64_t ns = stamp(0); ns <= stamp(22); ns += 5000000) {
    ImuSample sample;
    sample.stamp_ns = ns;
    sample.angular_velocity << 0.01, -0.01, kRate;
    sample.linear_acceleration << 0.03, kSpeed * kRate - 0.04,
        9.81 + (ns % 10000000 == 0 ? 0.01 : -0.01);  // never twice the same
    buffer.add(sample);
  }
  InertialMotion model(ImuCalibration(), {}, &buffer, false);
  const auto tilt_error = [&] { return std::acos(std::min(1.0, model.up().z())); };
  ASSERT_TRUE(model.initialize(stamp(2)));
  EXPECT_GT(tilt_error(), 0.25);
  EXPECT_LT(tilt_error(), 1.5 * model.tiltSigma());
  for (int frame = 3; frame <= 21; ++frame) {
    model.advanceTo(stamp(frame));
    model.correct(seen(pose(frame - 1).inverse() * pose(frame), 5e-3, 3e-4), true);
    model.markFrame();
    EXPECT_LT(tilt_error(), 3.0 * model.tiltSigma()) << frame;
  }
  EXPECT_LT(tilt_error(), 0.01);
  EXPECT_LT(model.accelerometerBias().norm(), 0.1);
}

struct LateScaleOutcome {
  double error, sigma;  // of the vertical [rad]
};

// Brakes from 10 m/s; until frame 14 the images show half the distance, of a scale that they say is poor. `failing`: a
// frame without vision, from which the window begins anew.
LateScaleOutcome lateScale(bool revise, int failing) {
  constexpr double kBraking = 2.5, kSpeed = 10.0;
  const auto pose = [](int frame) {
    const double t = 0.05 * frame;
    return motion({kSpeed * t - 0.5 * kBraking * t * t, 0.0, 0.0}, Eigen::Vector3d::Zero());
  };
  const auto stamp = [](int frame) { return std::int64_t{1000000000} + std::int64_t{50000000} * frame; };
  constexpr int kFirst = 4, kFound = 14;
  ImuBuffer buffer;
  for (std::int64_t ns = stamp(0); ns <= stamp(kFound + 1); ns += 5000000) {
    ImuSample sample;
    sample.stamp_ns = ns;
    sample.linear_acceleration << -kBraking, 0.0, 9.81 + (ns % 10000000 == 0 ? 0.01 : -0.01);
    buffer.add(sample);
  }
  InertialMotion model(ImuCalibration(), {}, &buffer, false);
  EXPECT_TRUE(model.initialize(stamp(kFirst)));
  for (int frame = kFirst + 1; frame <= kFound; ++frame) {
    const bool found = frame == kFound;
    WindowEstimate estimate;
    Eigen::Isometry3d step = pose(frame - 1).inverse() * pose(frame);
    if (!found) step.translation() *= frame < failing ? 0.2 : 0.5;
    estimate.vision = estimate.relative = seen(step, 1e-3, 3e-4);
    estimate.scale_state = found ? ScaleState::kObservable : ScaleState::kUnobservable;
    estimate.scale_noise = estimate.scale_sigma = found ? 0.01 : 1.0;
    estimate.lengthening = found ? 2.0 : 1.0;
    model.advanceTo(stamp(frame));
    if (frame != failing) {
      const LearnedMotion learned =
          learnedMotion(estimate, model.motionSinceFrame().T_a_b.translation(), false, 5.0, 400.0);
      model.correct(learned.vision, learned.use_displacement);
      if (revise) model.reviseStart(estimate);
    }
    if (!found) model.markFrame();
  }
  EXPECT_EQ(model.stamp(), stamp(kFound));
  EXPECT_NEAR(model.twist().linear.x(), kSpeed - kBraking * 0.05 * kFound, revise ? 0.2 : 5.0);
  const double error = std::acos(std::min(1.0, model.up().z()));
  EXPECT_LT(error, 3.0 * model.tiltSigma());
  return {error, model.tiltSigma()};
}

TEST(InertialMotion, AScaleThatIsFoundLateStraightensTheStart) {
  const LateScaleOutcome late = lateScale(false, 0), revised = lateScale(true, 0);
  EXPECT_GT(late.error, 0.1);
  EXPECT_LT(revised.error, 0.02);
  EXPECT_LT(revised.sigma, 0.5 * late.sigma);
}

TEST(InertialMotion, AScaleSaysNothingOfMotionsBeforeTheWindowBeganAnew) { EXPECT_LT(lateScale(true, 9).error, 0.05); }

TEST(InertialMotion, LateSamplesAreWorkedIn) {
  InertialRun in_time("handheld_stereo", 6.0, 1.0), late("handheld_stereo", 6.0, 1.0);
  late.buffer_.clear();
  std::size_t next = 0;
  const auto arrive = [&](std::int64_t until_ns) {
    while (next < late.imu_.size() && late.imu_[next].sample.stamp_ns <= until_ns) {
      late.buffer_.add(late.imu_[next++].sample);
    }
  };
  const Simulator& simulator = late.simulator_;
  arrive(simulator.frameStamp(1));
  for (InertialRun* run : {&in_time, &late}) ASSERT_TRUE(run->model_->initialize(simulator.frameStamp(0)));
  double rotation = 0.0, displacement = 0.0;
  int count = 0;
  for (int frame = 1; frame <= 110; ++frame) {
    arrive(simulator.frameStamp(frame) - 300000000);
    for (InertialRun* run : {&in_time, &late}) run->model_->advanceTo(simulator.frameStamp(frame));
    const MotionSummary summary = late.model_->motionSinceFrame();
    const Eigen::Isometry3d T = late.step(frame);
    const Eigen::Vector3d r = logSO3(summary.T_a_b.linear().transpose() * T.linear());
    const Eigen::Vector3d p = T.translation() - summary.T_a_b.translation();
    rotation += r.dot(summary.rotation_covariance.inverse() * r) / 3.0;
    displacement += p.dot(summary.translation_covariance.inverse() * p) / 3.0;
    ++count;
    for (InertialRun* run : {&in_time, &late}) {
      run->model_->correct(seen(T, 5e-4, 3e-4), true);
      run->model_->markFrame();
    }
  }
  EXPECT_LT(rotation / count, 2.0);
  EXPECT_LT(displacement / count, 2.0);
  // What is known of gravity and biases is that of 0.3 s before.
  EXPECT_LT(late.tiltError(110), 0.03);
  EXPECT_LT(late.tiltError(110), 3.0 * late.model_->tiltSigma());
  // Once the samples are there nothing is left of their being late.
  arrive(simulator.frameStamp(112));
  for (InertialRun* run : {&in_time, &late}) run->model_->advanceTo(simulator.frameStamp(111));
  EXPECT_EQ(late.model_->up(), in_time.model_->up());
  EXPECT_EQ(late.model_->motionSinceFrame().translation_covariance,
            in_time.model_->motionSinceFrame().translation_covariance);
}

TEST(InertialMotion, ASilentImuLeavesWhatVisionSees) {
  InertialRun run("handheld_stereo", 8.0, 1.0);
  std::vector<ImuSample> samples;
  run.buffer_.samplesBetween(0, run.simulator_.frameStamp(60), &samples);
  run.buffer_.clear();
  for (const ImuSample& sample : samples) run.buffer_.add(sample);
  ASSERT_TRUE(run.model_->initialize(run.simulator_.frameStamp(0)));
  run.run(1, 60, true, true);
  run.model_->markFrame();
  double rotation = 0.0;
  for (int frame = 61; frame <= 150; ++frame) {
    run.model_->advanceTo(run.simulator_.frameStamp(frame));
    const MotionSummary summary = run.model_->motionSinceFrame();
    const Eigen::Isometry3d T = run.step(frame);
    const Eigen::Vector3d r = logSO3(summary.T_a_b.linear().transpose() * T.linear());
    rotation += r.dot(summary.rotation_covariance.inverse() * r) / 3.0 / 90.0;
    EXPECT_LT(r.norm(), 0.03);  // goes on turning as vision saw
    run.model_->correct(seen(T, 5e-4, 3e-4), true);
    run.model_->markFrame();
  }
  EXPECT_LT(rotation, 2.0);
  EXPECT_LT(run.tiltError(150), 3.0 * run.model_->tiltSigma());
  EXPECT_LT(run.tiltError(150), 0.05);
}

}  // namespace
}  // namespace multicam_egomotion
