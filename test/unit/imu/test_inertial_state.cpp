// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>
#include <utility>
#include <vector>

#include "multicam_egomotion/geometry/covariance.h"
#include "multicam_egomotion/geometry/so3.h"
#include "multicam_egomotion/imu/imu_mounting.h"
#include "multicam_egomotion/imu/inertial_state.h"

namespace multicam_egomotion {
namespace {

constexpr double kOneDegree = M_PI / 180;
constexpr double kGravity = 9.81;
constexpr std::int64_t kBegin = 5000000000;
constexpr double kRateHz = 200;

/// A smooth motion known in closed form: position and three angles as sinusoids; `vigour` 0 is rest.
struct Trajectory {
  double vigour = 1.0;
  Eigen::Vector3d gyroscope_bias = Eigen::Vector3d::Zero();

  Eigen::Matrix3d attitude(double t) const {
    return expSO3(Eigen::Vector3d(0, 0, 0.4 + vigour * 0.9 * std::sin(0.7 * t))) *
           expSO3(Eigen::Vector3d(0, -0.2 + vigour * 0.35 * std::sin(1.3 * t + 0.5), 0)) *
           expSO3(Eigen::Vector3d(0.3 + vigour * 0.4 * std::sin(1.1 * t + 1.0), 0, 0));
  }
  Eigen::Vector3d position(double t) const {
    return vigour * Eigen::Vector3d(2.0 * std::sin(0.9 * t), 1.5 * std::sin(1.2 * t + 0.3), 0.5 * std::sin(1.7 * t));
  }
  Eigen::Vector3d velocity(double t) const {
    return vigour * Eigen::Vector3d(1.8 * std::cos(0.9 * t), 1.8 * std::cos(1.2 * t + 0.3), 0.85 * std::cos(1.7 * t));
  }
  Eigen::Vector3d acceleration(double t) const {
    return -vigour *
           Eigen::Vector3d(1.62 * std::sin(0.9 * t), 2.16 * std::sin(1.2 * t + 0.3), 1.445 * std::sin(1.7 * t));
  }
  Eigen::Vector3d rate(double t) const {
    const double h = 1e-4;
    return logSO3(attitude(t - h).transpose() * attitude(t + h)) / (2 * h);
  }
  ImuSample sample(double t) const {
    ImuSample sample;
    sample.stamp_ns = kBegin + std::llround(t * 1e9);
    sample.angular_velocity = rate(t) + gyroscope_bias;
    sample.linear_acceleration = attitude(t).transpose() * (acceleration(t) + Eigen::Vector3d(0, 0, kGravity));
    return sample;
  }
};

class Noise {
 public:
  explicit Noise(int seed) : generator_(seed) {}
  Eigen::Vector3d operator()(double sigma) {
    const double x = normal_(generator_), y = normal_(generator_), z = normal_(generator_);
    return sigma * Eigen::Vector3d(x, y, z);
  }

 private:
  std::mt19937 generator_;
  std::normal_distribution<double> normal_;
};

Eigen::Matrix3d isotropic(double sigma) { return sigma * sigma * Eigen::Matrix3d::Identity(); }

/// Only what the simulation has: no floors, no scale errors.
InertialStateOptions idealOptions() {
  InertialStateOptions options;
  options.gyroscope_noise_floor = options.accelerometer_noise_floor = 0;
  options.gyroscope_scale_sigma = options.accelerometer_scale_sigma = 0;
  return options;
}

Eigen::Vector2d tiltError(const InertialState& state, const Eigen::Matrix3d& R_true) {
  return shortestArc(state.attitude() * R_true.row(2).transpose(), Eigen::Vector3d::UnitZ()).head<2>();
}

std::vector<ImuSample> samplesOver(const Trajectory& motion, double begin, double end) {
  std::vector<ImuSample> samples;
  for (int i = std::lround(begin * kRateHz); i <= std::lround(end * kRateHz); ++i) {
    samples.push_back(motion.sample(i / kRateHz));
  }
  return samples;
}

/// Filter started over the 0.5 s before time 0.
InertialState started(const Trajectory& motion, const InertialStateOptions& options = {}) {
  InertialState state(ImuCalibration(), options);
  EXPECT_TRUE(state.initialize(samplesOver(motion, -0.5, 0)));
  return state;
}

void propagateOver(const Trajectory& motion, double begin, double end, InertialState* state) {
  for (int i = std::lround(begin * kRateHz) + 1; i <= std::lround(end * kRateHz); ++i) {
    state->propagate(motion.sample(i / kRateHz));
  }
}

/// Vision's corrections, exact, at 20 Hz.
void followOver(const Trajectory& motion, double begin, double end, InertialState* state) {
  for (int i = std::lround(begin * 20); i < std::lround(end * 20); ++i) {
    const double t1 = i / 20.0, t2 = (i + 1) / 20.0;
    propagateOver(motion, t1, t2, state);
    state->correctRelativeRotation(motion.attitude(t1).transpose() * motion.attitude(t2), isotropic(0.05 * kOneDegree));
    state->correctVelocity(motion.attitude(t2).transpose() * motion.velocity(t2), isotropic(0.05));
    state->markFrame();
  }
}

TEST(InertialState, RefusesWrongOptions) {
  const auto with = [](double InertialStateOptions::*option, double value) {
    InertialStateOptions options;
    options.*option = value;
    InertialState state(ImuCalibration(), options);
  };
  EXPECT_THROW(with(&InertialStateOptions::gravity, 0), std::invalid_argument);
  EXPECT_THROW(with(&InertialStateOptions::initial_velocity_sigma, -1), std::invalid_argument);
  EXPECT_THROW(with(&InertialStateOptions::accelerometer_noise_floor, -1), std::invalid_argument);
  EXPECT_THROW(with(&InertialStateOptions::gyroscope_bias_sigma, NAN), std::invalid_argument);
  ImuCalibration calibration;
  calibration.gyroscope_noise_density = 0;
  EXPECT_THROW(InertialState{calibration}, std::invalid_argument);
}

TEST(InertialState, StartsAtRestWithTheGyroscopeBias) {
  const Trajectory rest{0.0, Eigen::Vector3d::Zero()};
  const Eigen::Vector3d bias(0.08, -0.03, 0.02);
  Noise noise(1);
  std::vector<ImuSample> samples = samplesOver(rest, -0.5, 0);
  for (ImuSample& sample : samples) {
    sample.angular_velocity += bias + noise(0.003);
    sample.linear_acceleration += noise(0.03);
  }
  InertialState state{ImuCalibration()};
  ASSERT_TRUE(state.initialize(samples));
  EXPECT_TRUE(state.startedStill());
  EXPECT_LT((state.gyroscopeBias() - bias).norm(), 0.002);
  EXPECT_LT(std::sqrt(state.gyroscopeBiasCovariance()(0, 0)), 0.006);
  EXPECT_LT(tiltError(state, rest.attitude(0)).norm(), 0.2 * kOneDegree);
  EXPECT_LT(state.tiltSigma(), 1.5 * kOneDegree);
  EXPECT_GT(state.tiltSigma(), 0.5 * kOneDegree);  // the accelerometer bias is unknown
  EXPECT_NEAR(std::sqrt(state.velocityCovariance()(0, 0)), 5.0, 0.1);
}

TEST(InertialState, StartsInMotionWithAWideTilt) {
  const Trajectory motion;
  const InertialState state = started(motion);
  EXPECT_FALSE(state.startedStill());
  EXPECT_GT(state.tiltSigma(), 3 * kOneDegree);
  EXPECT_LT(tiltError(state, motion.attitude(0)).norm(), 3 * state.tiltSigma());
}

TEST(InertialState, DoesNotTakeASmoothCurveForRest) {
  // A car that turns steadily: as quiet as at rest, and the force is 17 deg off the vertical.
  std::vector<ImuSample> samples;
  for (int i = 0; i <= 24; ++i) {
    ImuSample sample;
    sample.stamp_ns = 1000000000 + 5000000 * i;
    sample.angular_velocity << 0.0, 0.0, 0.3;
    sample.linear_acceleration << 0.0, 3.0, 9.81;
    samples.push_back(sample);
  }
  InertialState state{ImuCalibration()};
  ASSERT_TRUE(state.initialize(samples));
  EXPECT_FALSE(state.startedStill());
  const double error = std::acos(state.attitude()(2, 2));
  EXPECT_GT(error, 16.0 * kOneDegree);
  EXPECT_LT(error, 1.5 * state.tiltSigma());
}

TEST(InertialState, PutsOdomXAlongTheBody) {
  ImuCalibration calibration;
  calibration.T_body_imu.linear() = expSO3(Eigen::Vector3d(1.0, -2.0, 0.5));
  InertialState state(calibration);
  ASSERT_TRUE(state.initialize(samplesOver(Trajectory{0.0, Eigen::Vector3d::Zero()}, -0.5, 0)));
  const Eigen::Matrix3d R_odom_body = state.attitude() * calibration.T_body_imu.linear().transpose();
  const Eigen::Vector3d up_in_body =
      calibration.T_body_imu.linear() * Trajectory{0.0, Eigen::Vector3d::Zero()}.attitude(0).row(2).transpose();
  EXPECT_TRUE(R_odom_body.isApprox(levelAttitude(up_in_body), 1e-6));
}

TEST(InertialState, RefusesToStartWithoutEnoughSamples) {
  const Trajectory motion;
  InertialState state{ImuCalibration()};
  EXPECT_FALSE(state.initialize({}));
  EXPECT_FALSE(state.initialize(samplesOver(motion, -0.05, 0)));
  std::vector<ImuSample> free_fall = samplesOver(motion, -0.5, 0);
  for (ImuSample& sample : free_fall) {
    sample.linear_acceleration.setZero();
  }
  EXPECT_FALSE(state.initialize(free_fall));
  EXPECT_FALSE(state.initialized());
}

TEST(InertialState, PredictsRotationAndDisplacementSinceTheFrame) {
  const Trajectory motion;
  InertialState state = started(motion, idealOptions());
  followOver(motion, 0, 20, &state);
  const double t1 = 20, t2 = 20.25;
  propagateOver(motion, t1, t2, &state);
  const Eigen::Matrix3d R_1_2 = motion.attitude(t1).transpose() * motion.attitude(t2);
  const Eigen::Vector3d p_1_2 = motion.attitude(t1).transpose() * (motion.position(t2) - motion.position(t1));
  EXPECT_LT(logSO3(R_1_2.transpose() * state.rotationSinceFrame()).norm(), 0.02 * kOneDegree);
  EXPECT_LT((state.displacementSinceFrame() - p_1_2).norm(), 0.01);
  EXPECT_LT((state.velocityInImuAxes() - motion.attitude(t2).transpose() * motion.velocity(t2)).norm(), 0.03);
  EXPECT_LT((state.angularVelocity() - motion.rate(t2)).norm(), 0.005);
  EXPECT_EQ(state.frameStamp(), kBegin + 20000000000);
}

TEST(InertialState, IsConsistentOverManyRuns) {
  const Trajectory motion;
  const InertialStateOptions options = idealOptions();
  const ImuCalibration imu;
  const int runs = 50;
  const double rotation_sigma = 0.05 * kOneDegree, velocity_sigma = 0.05, displacement_sigma = 0.0025;
  for (const bool by_displacement : {false, true}) {
    double tilt = 0, velocity = 0, gyroscope_bias = 0, accelerometer_bias = 0, rotation = 0, displacement = 0;
    int checks = 0;
    for (int run = 0; run < runs; ++run) {
      Noise noise(run + 1);
      Eigen::Vector3d bias_g = noise(options.gyroscope_bias_sigma), bias_a = noise(options.accelerometer_bias_sigma);
      const auto measured = [&](double t) {
        bias_g += noise(imu.gyroscope_random_walk / std::sqrt(kRateHz));
        bias_a += noise(imu.accelerometer_random_walk / std::sqrt(kRateHz));
        ImuSample sample = motion.sample(t);
        sample.angular_velocity += bias_g + noise(imu.gyroscope_noise_density * std::sqrt(kRateHz));
        sample.linear_acceleration += bias_a + noise(imu.accelerometer_noise_density * std::sqrt(kRateHz));
        return sample;
      };
      const double origin = 3.7 * run;  // another phase of the motion
      std::vector<ImuSample> samples;
      for (int i = -100; i <= 0; ++i) {
        samples.push_back(measured(origin + i / kRateHz));
      }
      InertialState state(imu, options);
      ASSERT_TRUE(state.initialize(samples));
      for (int frame = 1; frame <= 200; ++frame) {
        const double t1 = origin + (frame - 1) / 20.0, t2 = origin + frame / 20.0;
        for (int i = 1; i <= 10; ++i) {
          state.propagate(measured(t1 + i / kRateHz));
        }
        const Eigen::Matrix3d R1 = motion.attitude(t1), R2 = motion.attitude(t2);
        const Eigen::Vector3d p_1_2 = R1.transpose() * (motion.position(t2) - motion.position(t1));
        const Eigen::Vector3d velocity_true = R2.transpose() * motion.velocity(t2);
        const bool check = frame == 60 || frame == 120 || frame == 200;
        if (check) {
          const Eigen::Vector3d r = logSO3(state.rotationSinceFrame().transpose() * R1.transpose() * R2);
          const Eigen::Vector3d d = p_1_2 - state.displacementSinceFrame();
          rotation += squaredMahalanobis(r, state.rotationSinceFrameCovariance()) / 3;
          displacement += squaredMahalanobis(d, state.displacementSinceFrameCovariance()) / 3;
        }
        state.correctRelativeRotation(R1.transpose() * R2 * expSO3(noise(rotation_sigma)), isotropic(rotation_sigma));
        if (by_displacement) {
          state.correctDisplacement(p_1_2 + noise(displacement_sigma), isotropic(displacement_sigma));
        } else {
          state.correctVelocity(velocity_true + noise(velocity_sigma), isotropic(velocity_sigma));
        }
        state.markFrame();
        if (check) {
          const Eigen::Vector2d e = tiltError(state, R2);
          const Eigen::Vector3d v = velocity_true - state.velocityInImuAxes();
          const Eigen::Vector3d g = bias_g - state.gyroscopeBias(), a = bias_a - state.accelerometerBias();
          tilt += squaredMahalanobis(e, state.tiltCovariance()) / 2;
          velocity += squaredMahalanobis(v, state.velocityCovarianceInImuAxes()) / 3;
          gyroscope_bias += squaredMahalanobis(g, state.gyroscopeBiasCovariance()) / 3;
          accelerometer_bias += squaredMahalanobis(a, state.accelerometerBiasCovariance()) / 3;
          ++checks;
        }
      }
    }
    // 150 checks, three of one run not independent: the mean of 50 χ² of 2 or 3 degrees stays within these bounds.
    for (const auto& [name, sum] :
         {std::pair("tilt", tilt), std::pair("velocity", velocity), std::pair("gyroscope bias", gyroscope_bias),
          std::pair("accelerometer bias", accelerometer_bias), std::pair("rotation", rotation),
          std::pair("displacement", displacement)}) {
      EXPECT_GT(sum / checks, 0.65) << name << " NEES, by_displacement " << by_displacement;
      EXPECT_LT(sum / checks, 1.5) << name << " NEES, by_displacement " << by_displacement;
    }
  }
}

TEST(InertialState, RejectsAnOutlierAndRecoversFromAWrongState) {
  const Trajectory motion;
  InertialState state = started(motion);
  followOver(motion, 0, 10, &state);
  propagateOver(motion, 10, 10.05, &state);
  const Eigen::Matrix3d before = state.attitude();
  const Eigen::Matrix3d R_1_2 = motion.attitude(10).transpose() * motion.attitude(10.05);
  EXPECT_FALSE(state.correctRelativeRotation(R_1_2 * expSO3(Eigen::Vector3d(0.2, 0, 0)), isotropic(0.05 * kOneDegree)));
  EXPECT_EQ(state.rotationCounts().rejected, 1u);
  EXPECT_EQ(state.attitude(), before);
  EXPECT_TRUE(state.correctRelativeRotation(R_1_2, isotropic(0.05 * kOneDegree)));
  EXPECT_EQ(state.rotationCounts().consecutive_rejections, 0);

  // Another velocity from now on, as after a wrong scale: believed within a few frames.
  const Eigen::Vector3d velocity = state.velocityInImuAxes() + Eigen::Vector3d(8, 0, 0);
  EXPECT_FALSE(state.correctVelocity(velocity, isotropic(0.05)));
  EXPECT_FALSE(state.correctVelocity(velocity, isotropic(0.05)));
  EXPECT_TRUE(state.correctVelocity(velocity, isotropic(0.05)));
  EXPECT_EQ(state.velocityCounts().recoveries, 1u);
  EXPECT_LT((state.velocityInImuAxes() - velocity).norm(), 0.1);
}

TEST(InertialState, IgnoresAndCountsBadInput) {
  const Trajectory motion;
  InertialState state = started(motion);
  followOver(motion, 0, 1, &state);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  ImuSample bad = motion.sample(1.005);
  bad.angular_velocity.x() = nan;
  state.propagate(bad);
  bad = motion.sample(1.005);
  bad.linear_acceleration.x() = 1e200;
  state.propagate(bad);
  state.propagate(motion.sample(0.5));
  EXPECT_EQ(state.ignoredSamples(), 3u);
  const Eigen::Matrix3d zero = Eigen::Matrix3d::Zero();
  EXPECT_FALSE(state.correctVelocity(Eigen::Vector3d(nan, 0, 0), isotropic(1)));
  EXPECT_FALSE(state.correctVelocity(Eigen::Vector3d::Zero(), zero));
  EXPECT_FALSE(state.correctVelocity(Eigen::Vector3d::Zero(), -isotropic(1)));
  EXPECT_FALSE(state.correctDisplacement(Eigen::Vector3d::Zero(), nan * isotropic(1)));
  EXPECT_FALSE(state.correctRelativeRotation(nan * Eigen::Matrix3d::Identity(), isotropic(1)));
  EXPECT_FALSE(state.correctRelativeRotation(2 * Eigen::Matrix3d::Identity(), isotropic(1)));
  EXPECT_FALSE(state.correctTilt(zero, 0.1));
  EXPECT_FALSE(state.correctTilt(Eigen::Matrix3d::Identity(), 0));
  EXPECT_EQ(state.velocityCounts().invalid, 4u);
  EXPECT_EQ(state.rotationCounts().invalid, 2u);
  EXPECT_EQ(state.tiltCounts().invalid, 2u);
  followOver(motion, 1, 5, &state);
  EXPECT_TRUE(state.attitude().allFinite() && state.velocityCovariance().allFinite());
  EXPECT_LT(tiltError(state, motion.attitude(5)).norm(), 3 * state.tiltSigma());
}

TEST(InertialState, TakesOnlyTheVerticalOfAnExternalAttitude) {
  const Trajectory rest{0.0, Eigen::Vector3d::Zero()};
  InertialState state = started(rest);
  const Eigen::Vector3d odom_x = state.attitude().row(0);
  const Eigen::Matrix3d tilted = expSO3(Eigen::Vector3d(0.02, -0.01, 0)) * rest.attitude(0);
  EXPECT_TRUE(state.correctTilt(expSO3(Eigen::Vector3d(0, 0, 2.5)) * tilted, 1e-4));
  EXPECT_LT(tiltError(state, tilted).norm(), 1e-3);
  EXPECT_LT((odom_x - state.attitude().row(0).transpose()).norm(), 0.03);  // no yaw
}

TEST(InertialState, WidensOverAGapAndSaysSo) {
  const Trajectory motion;
  ImuBuffer whole, holed;
  for (const ImuSample& sample : samplesOver(motion, -0.5, 6)) {
    whole.add(sample);
    const double t = 1e-9 * static_cast<double>(sample.stamp_ns - kBegin);
    if (t < 5.2 || t > 5.4) {
      holed.add(sample);
    }
  }
  InertialState state = started(motion);
  followOver(motion, 0, 5, &state);
  InertialState with_gap = state;
  const std::int64_t end = kBegin + 5501000000;
  EXPECT_TRUE(state.propagateTo(end, whole));
  EXPECT_TRUE(with_gap.propagateTo(end, holed));
  EXPECT_EQ(with_gap.stamp(), end);
  const double sigma = std::sqrt(state.rotationSinceFrameCovariance().trace());
  const double sigma_with_gap = std::sqrt(with_gap.rotationSinceFrameCovariance().trace());
  EXPECT_GT(sigma_with_gap, 3 * sigma);
  const Eigen::Matrix3d R_1_2 = motion.attitude(5).transpose() * motion.attitude(5.501);
  EXPECT_LT(logSO3(R_1_2.transpose() * with_gap.rotationSinceFrame()).norm(), 3 * sigma_with_gap);
  EXPECT_FALSE(state.propagateTo(kBegin + 6100000000, whole));  // 0.1 s more than there is
  EXPECT_EQ(state.stamp(), kBegin + 6100000000);
  EXPECT_FALSE(state.propagateTo(kBegin, whole));
}

TEST(InertialState, ASilentImuIsAGapHoweverOftenItIsAsked) {
  const Trajectory motion;
  ImuBuffer silent, holed;
  for (const ImuSample& sample : samplesOver(motion, -0.5, 10)) {
    const double t = 1e-9 * static_cast<double>(sample.stamp_ns - kBegin);
    if (t <= 5) silent.add(sample);
    if (t <= 5 || t >= 6.5) holed.add(sample);
  }
  InertialState seldom = started(motion);
  followOver(motion, 0, 5, &seldom);
  InertialState often = seldom, across = seldom;
  EXPECT_FALSE(seldom.propagateTo(kBegin + 6500000000, silent));
  double sigma = 0, tilt_sigma = 0;
  for (int i = 1; i <= 60; ++i) {
    const double t = 5 + i * 0.025;
    EXPECT_FALSE(often.propagateTo(kBegin + std::llround(t * 1e9), silent));
    across.propagateTo(kBegin + std::llround(t * 1e9), holed);
    EXPECT_GT(often.displacementSinceFrameCovariance().trace(), sigma);  // nothing is learnt from what is held
    EXPECT_GT(often.tiltSigma(), tilt_sigma);
    sigma = often.displacementSinceFrameCovariance().trace();
    tilt_sigma = often.tiltSigma();
  }
  const Eigen::Vector3d p = motion.attitude(5).transpose() * (motion.position(6.5) - motion.position(5));
  for (const InertialState* state : {&seldom, &often, &across}) {
    const Eigen::Vector3d error = p - state->displacementSinceFrame();
    EXPECT_LT(squaredMahalanobis(error, state->displacementSinceFrameCovariance()), 14.2);
    EXPECT_LT(tiltError(*state, motion.attitude(6.5)).norm(), 3 * state->tiltSigma());
    EXPECT_GT(state->tiltSigma(), 20 * kOneDegree);
  }
  EXPECT_NEAR(often.tiltSigma(), seldom.tiltSigma(), 0.1 * seldom.tiltSigma());
  propagateOver(motion, 6.5, 6.6, &across);
  followOver(motion, 6.6, 10, &across);
  EXPECT_LT(tiltError(across, motion.attitude(10)).norm(), 3 * across.tiltSigma());
  EXPECT_LT(tiltError(across, motion.attitude(10)).norm(), 2 * kOneDegree);
}

// As where the buffer was cleared: what comes after the hole says nothing of the time within it.
TEST(InertialState, SamplesOfLaterOnlyAreAGap) {
  const Trajectory motion;
  ImuBuffer before, after;
  for (const ImuSample& sample : samplesOver(motion, -0.5, 7)) {
    const double t = 1e-9 * static_cast<double>(sample.stamp_ns - kBegin);
    if (t <= 5) before.add(sample);
    if (t >= 6) after.add(sample);
  }
  InertialState silent = started(motion);
  followOver(motion, 0, 5, &silent);
  InertialState later = silent;
  EXPECT_FALSE(silent.propagateTo(kBegin + 5500000000, before));
  EXPECT_FALSE(later.propagateTo(kBegin + 5500000000, after));
  EXPECT_TRUE(later.rotationSinceFrameCovariance().isApprox(silent.rotationSinceFrameCovariance(), 1e-3));
  EXPECT_TRUE(later.displacementSinceFrameCovariance().isApprox(silent.displacementSinceFrameCovariance(), 1e-3));
}

TEST(InertialState, VisionWinsOverABrokenGyroscope) {
  // Cut at 0.3 rad/s for a second, as by a range that is too small.
  Trajectory motion;
  motion.vigour = 1.5;
  InertialState state = started(motion);
  followOver(motion, 0, 8, &state);
  const Eigen::Vector3d bias = state.gyroscopeBias();
  const auto follow = [&](int frame, bool cut) {
    const double t1 = frame / 20.0, t2 = (frame + 1) / 20.0;
    for (int i = frame * 10 + 1; i <= frame * 10 + 10; ++i) {
      ImuSample sample = motion.sample(i / kRateHz);
      if (cut) sample.angular_velocity = sample.angular_velocity.cwiseMax(-0.3).cwiseMin(0.3);
      state.propagate(sample);
    }
    const Eigen::Matrix3d R = motion.attitude(t1).transpose() * motion.attitude(t2);
    const Eigen::Vector3d off = logSO3(state.rotationSinceFrame().transpose() * R);
    const double nees = squaredMahalanobis(off, state.rotationSinceFrameCovariance());
    state.correctRelativeRotation(R, isotropic(0.05 * kOneDegree));
    state.correctVelocity(motion.attitude(t2).transpose() * motion.velocity(t2), isotropic(0.05));
    state.markFrame();
    return nees;
  };
  int surprises = 0;
  for (int frame = 160; frame < 180; ++frame) surprises += follow(frame, true) > 16.3;
  EXPECT_GE(state.rotationCounts().recoveries, 1u);
  EXPECT_LE(surprises, 8);
  for (int frame = 180; frame < 220; ++frame) follow(frame, false);
  EXPECT_LT(tiltError(state, motion.attitude(11)).norm(), 3 * state.tiltSigma());
  EXPECT_LT(tiltError(state, motion.attitude(11)).norm(), 1.5 * kOneDegree);
  EXPECT_LT((state.gyroscopeBias() - bias).norm(), 0.02);
}

TEST(InertialState, KeepsTheVerticalThroughALongOutageOfVision) {
  const Trajectory motion{1.0, {0.02, -0.01, 0.015}};
  InertialState state = started(motion);
  for (int second = 1; second <= 120; ++second) {
    propagateOver(motion, second - 1, second, &state);
    ASSERT_LT(tiltError(state, motion.attitude(second)).norm(), 3 * state.tiltSigma()) << second;
  }
  EXPECT_LT(state.tiltSigma(), 5 * kOneDegree);
  EXPECT_LT(std::sqrt(state.velocityCovarianceInImuAxes()(0, 0)), 15.0);  // bounded
  followOver(motion, 120, 125, &state);
  EXPECT_LT(tiltError(state, motion.attitude(125)).norm(), 3 * state.tiltSigma());
}

TEST(InertialState, CoversWhatACommonCauseChanges) {
  const Trajectory motion;
  InertialState state = started(motion);
  followOver(motion, 0, 2, &state);
  InertialState other = state;
  ASSERT_TRUE(other.correctVelocity(state.velocityInImuAxes() + Eigen::Vector3d(0.01, 0.02, -0.01), isotropic(0.01)));
  const Eigen::Vector3d velocity = other.velocityInImuAxes() - state.velocityInImuAxes();
  const Eigen::Vector3d theta = logSO3(other.attitude() * state.attitude().transpose());
  ASSERT_GT(velocity.norm(), 1e-3);
  ASSERT_GT(theta.norm(), 1e-5);
  const Eigen::Matrix3d velocity_covariance = state.velocityCovarianceInImuAxes() + velocity * velocity.transpose();
  const Eigen::Matrix3d attitude_covariance = state.attitudeCovariance() + theta * theta.transpose();
  const Eigen::Matrix3d attitude = state.attitude();
  state.addCommonError(other, 1.0, 0.0);
  EXPECT_LT((state.velocityCovarianceInImuAxes() - velocity_covariance).norm(), 1e-12);
  EXPECT_LT((state.attitudeCovariance() - attitude_covariance).norm(), 1e-12);
  EXPECT_EQ(state.attitude(), attitude);
}

TEST(InertialState, ACommonErrorOfLengthsIsPartlyKnown) {
  // Noise and the unknown lengths share what longer lengths change; that of the lengths is corrected with them.
  const Trajectory motion;
  InertialStateOptions options;
  options.length_sigma = 0.05;
  InertialState state = started(motion, options);
  followOver(motion, 0, 2, &state);
  InertialState other = state;
  ASSERT_TRUE(other.correctVelocity(state.velocityInImuAxes() + Eigen::Vector3d(0.01, 0.02, -0.01), isotropic(0.01)));
  const Eigen::Vector3d velocity = other.velocityInImuAxes() - state.velocityInImuAxes();
  const Eigen::Matrix3d covariance = state.velocityCovarianceInImuAxes() + velocity * velocity.transpose();
  state.addCommonError(other, 0.6, 0.8);
  EXPECT_LT((state.velocityCovarianceInImuAxes() - covariance).norm(), 1e-12);
  EXPECT_NEAR(state.lengthSigma(), 0.05, 1e-12);
  EXPECT_EQ(state.lengthError(), 0.0);
}

TEST(InertialState, RestartsAtAnotherTimeWithItsBiases) {
  const Trajectory motion;
  InertialState state = started(motion);
  followOver(motion, 0, 10, &state);
  const double sigma = state.tiltSigma();
  const Eigen::Vector3d bias = state.gyroscopeBias();
  state.restartAt(1000, 10 * kOneDegree);
  EXPECT_EQ(state.stamp(), 1000);
  EXPECT_EQ(state.frameStamp(), 1000);
  EXPECT_EQ(state.gyroscopeBias(), bias);
  EXPECT_NEAR(state.tiltSigma(), std::hypot(sigma, 10 * kOneDegree), 1e-6);
  EXPECT_NEAR(state.velocityCovarianceInImuAxes()(1, 1), 25, 1e-9);
  EXPECT_TRUE(state.velocity().isZero());

  InertialState again = started(motion);
  followOver(motion, 0, 10, &again);
  const double known = again.gyroscopeBiasCovariance()(0, 0);
  ASSERT_TRUE(again.initialize(samplesOver(motion, 9.5, 10)));
  EXPECT_LE(again.gyroscopeBiasCovariance()(0, 0), known);
  again.forgetBiases();
  EXPECT_NEAR(again.gyroscopeBiasCovariance()(0, 0), 0.01, 1e-12);
  EXPECT_TRUE(again.gyroscopeBias().isZero());
}

}  // namespace
}  // namespace multicam_egomotion
