// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include "multicam_egomotion/geometry/so3.h"
#include "multicam_egomotion/imu/gyroscope_integration.h"

namespace multicam_egomotion {
namespace {

constexpr std::int64_t kOrigin = 1000000000;
const Eigen::Vector3d kNoBias = Eigen::Vector3d::Zero();

ImuBuffer bufferOf(const std::function<Eigen::Vector3d(double)>& rate, double rate_hz, double duration_s) {
  ImuBuffer buffer;
  for (int i = 0; i <= std::lround(duration_s * rate_hz); ++i) {
    ImuSample sample;
    sample.stamp_ns = kOrigin + std::llround(1e9 * i / rate_hz);
    sample.angular_velocity = rate(i / rate_hz);
    buffer.add(sample);
  }
  return buffer;
}

/// Coning: the body z axis moves on a cone of half-angle `angle` with `frequency` [rad/s].
Eigen::Matrix3d coningAttitude(double t, double angle, double frequency) {
  return expSO3(angle * Eigen::Vector3d(std::cos(frequency * t), std::sin(frequency * t), 0));
}

Eigen::Vector3d coningRate(double t, double angle, double frequency) {
  return frequency * Eigen::Vector3d(-std::sin(angle) * std::sin(frequency * t),
                                     std::sin(angle) * std::cos(frequency * t), -(1 - std::cos(angle)));
}

TEST(GyroscopeIntegration, IsExactForConstantRate) {
  const Eigen::Vector3d rate(0.4, -1.2, 2.0);
  const ImuBuffer buffer = bufferOf([&](double) { return rate; }, 200, 1.0);
  const auto rotation = integrateGyroscope(buffer, kOrigin + 3000000, kOrigin + 903000000, kNoBias, 1e-3);
  EXPECT_TRUE(rotation.R_1_2.isApprox(expSO3(0.9 * rate), 1e-12));
  EXPECT_NEAR(rotation.duration_s, 0.9, 1e-9);
  EXPECT_NEAR(rotation.largest_gap_s, 0.005, 1e-9);
  EXPECT_TRUE(rotation.complete);
}

TEST(GyroscopeIntegration, FollowsConing) {
  const double angle = 0.2, frequency = 2 * M_PI * 3;
  const ImuBuffer buffer = bufferOf([&](double t) { return coningRate(t, angle, frequency); }, 200, 2.0);
  const Eigen::Matrix3d truth = coningAttitude(0, angle, frequency).transpose() * coningAttitude(2.0, angle, frequency);
  const auto rotation = integrateGyroscope(buffer, kOrigin, kOrigin + 2000000000, kNoBias, 1e-3);
  EXPECT_LT(logSO3(truth.transpose() * rotation.R_1_2).norm(), 2e-3);

  // The coning term is what keeps it there: the trapezoid alone drifts about z with every turn.
  Eigen::Matrix3d trapezoid = Eigen::Matrix3d::Identity();
  for (int i = 0; i < 400; ++i) {
    trapezoid *=
        expSO3(0.0025 * (coningRate(i * 0.005, angle, frequency) + coningRate(i * 0.005 + 0.005, angle, frequency)));
  }
  EXPECT_LT(logSO3(truth.transpose() * rotation.R_1_2).norm(), 0.7 * logSO3(truth.transpose() * trapezoid).norm());
}

TEST(GyroscopeIntegration, ConvergesWithSecondOrder) {
  const auto rate = [](double t) {
    return Eigen::Vector3d(1.5 * std::sin(5 * t), -std::cos(7 * t), 0.8 * std::sin(3 * t + 1));
  };
  const auto integrate = [&](double rate_hz) {
    return integrateGyroscope(bufferOf(rate, rate_hz, 1.0), kOrigin, kOrigin + 1000000000, kNoBias, 1e-3).R_1_2;
  };
  const Eigen::Matrix3d fine = integrate(5000);
  const double coarse_error = logSO3(fine.transpose() * integrate(50)).norm();
  const double half_error = logSO3(fine.transpose() * integrate(100)).norm();
  EXPECT_LT(coarse_error, 1e-2);
  EXPECT_GT(coarse_error / half_error, 3.5);
}

TEST(GyroscopeIntegration, BiasJacobianMatchesDifferences) {
  const auto rate = [](double t) { return Eigen::Vector3d(2 * std::sin(3 * t), 1.0, -std::cos(2 * t)); };
  const ImuBuffer buffer = bufferOf(rate, 200, 1.0);
  const Eigen::Vector3d bias(0.02, -0.05, 0.03);
  const auto at = [&](const Eigen::Vector3d& b) {
    return integrateGyroscope(buffer, kOrigin, kOrigin + 812000000, b, 1);
  };
  const auto rotation = at(bias);
  const double h = 1e-5;
  for (int k = 0; k < 3; ++k) {
    const Eigen::Vector3d step = h * Eigen::Vector3d::Unit(k);
    const Eigen::Vector3d column = logSO3(at(bias - step).R_1_2.transpose() * at(bias + step).R_1_2) / (2 * h);
    EXPECT_LT((column - rotation.bias_jacobian.col(k)).norm(), 2e-4) << k;
  }
}

TEST(GyroscopeIntegration, CovarianceMatchesScatter) {
  const double density = 2e-3, rate_hz = 200;
  const auto rate = [](double t) { return Eigen::Vector3d(3 * std::sin(4 * t), 1.5, -2 * std::cos(5 * t)); };
  const std::int64_t end = kOrigin + 500000000;
  const auto truth = integrateGyroscope(bufferOf(rate, rate_hz, 0.5), kOrigin, end, kNoBias, density);
  std::mt19937 generator(7);
  std::normal_distribution<double> normal(0, density * std::sqrt(rate_hz));
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  const int runs = 2000;
  for (int run = 0; run < runs; ++run) {
    const auto noisy = [&](double t) -> Eigen::Vector3d {
      return rate(t) + Eigen::Vector3d(normal(generator), normal(generator), normal(generator));
    };
    const auto R = integrateGyroscope(bufferOf(noisy, rate_hz, 0.5), kOrigin, end, kNoBias, density).R_1_2;
    const Eigen::Vector3d error = logSO3(R.transpose() * truth.R_1_2);
    scatter += error * error.transpose() / runs;
  }
  EXPECT_LT((scatter - truth.covariance).norm(), 0.12 * truth.covariance.norm());
}

TEST(GyroscopeIntegration, BackwardsIsTheInverse) {
  const auto rate = [](double t) { return Eigen::Vector3d(std::sin(t), 0.7, -t); };
  const ImuBuffer buffer = bufferOf(rate, 200, 1.0);
  const std::int64_t end = kOrigin + 700000000;
  const auto there = integrateGyroscope(buffer, kOrigin, end, kNoBias, 1e-3);
  const auto back = integrateGyroscope(buffer, end, kOrigin, kNoBias, 1e-3);
  EXPECT_TRUE((there.R_1_2 * back.R_1_2).isIdentity(1e-12));
  const Eigen::Vector3d step(1e-6, -2e-6, 1e-6);
  const auto moved = integrateGyroscope(buffer, end, kOrigin, step, 1e-3);
  EXPECT_LT((logSO3(back.R_1_2.transpose() * moved.R_1_2) - back.bias_jacobian * step).norm(), 1e-9);
}

TEST(GyroscopeIntegration, ReportsWhatIsNotCovered) {
  const ImuBuffer buffer = bufferOf([](double) { return Eigen::Vector3d(1, 0, 0); }, 200, 0.5);
  const auto rotation = integrateGyroscope(buffer, kOrigin + 400000000, kOrigin + 600000000, kNoBias, 1e-3);
  EXPECT_FALSE(rotation.complete);
  EXPECT_NEAR(rotation.duration_s, 0.1, 1e-9);
  EXPECT_NEAR(rotation.largest_gap_s, 0.1, 1e-9);
  EXPECT_FALSE(integrateGyroscope(ImuBuffer(), 1, 2, kNoBias, 1e-3).complete);
}

}  // namespace
}  // namespace multicam_egomotion
