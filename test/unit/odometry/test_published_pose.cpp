// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>

#include "multicam_egomotion/geometry/so3.h"
#include "multicam_egomotion/odometry/published_pose.h"

namespace multicam_egomotion {
namespace {

Eigen::Isometry3d pose(const Eigen::Vector3d& p, const Eigen::Vector3d& rotation_vector) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = expSO3(rotation_vector);
  T.translation() = p;
  return T;
}

double angleBetween(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
  return logSO3(a.linear().transpose() * b.linear()).norm();
}

constexpr double kInterval = 0.05;
const Eigen::Isometry3d kAdvance = pose({0.05, 0.01, 0.0}, {0.0, 0.0, 0.02});

TEST(PublishedPose, FollowsAWindowThatDoesNotChangeItsMind) {
  PublishedPose published;
  Eigen::Isometry3d window = pose({1.0, 2.0, 3.0}, {0.1, 0.2, 0.3});
  published.start(window);
  for (int i = 0; i < 200; ++i) {
    published.follow(window, window * kAdvance, kInterval);
    window = window * kAdvance;
    EXPECT_LT((published.pose().translation() - window.translation()).norm(), 1e-9);
    EXPECT_LT(angleBetween(published.pose(), window), 1e-9);
  }
}

TEST(PublishedPose, CorrectionsOfThePastAreNoJumpsAndDecay) {
  PublishedPose published;
  Eigen::Isometry3d window = Eigen::Isometry3d::Identity();
  published.start(window);
  // The window finds the previous frame elsewhere: 20 cm and 2 deg.
  const Eigen::Isometry3d correction = pose({0.16, -0.12, 0.0}, {0.0, 0.035, 0.0});
  window = correction * window;
  for (int i = 0; i < 60; ++i) {
    const Eigen::Isometry3d before = published.pose();
    published.follow(window, window * kAdvance, kInterval);
    window = window * kAdvance;
    const Eigen::Isometry3d moved = before.inverse() * published.pose();
    // A tenth of the correction a frame at most comes on top of the motion.
    EXPECT_LT((moved.translation() - kAdvance.translation()).norm(), 0.11 * 0.2 + 0.002);
    EXPECT_LT(angleBetween(moved, kAdvance), 0.11 * 0.035 + 1e-6);
    const double share = std::exp(-(i + 1) * kInterval / 0.5);
    EXPECT_NEAR((published.pose().translation() - window.translation()).norm(), share * 0.2, 0.02);
    EXPECT_NEAR(angleBetween(published.pose(), window), share * 0.035, 1e-6);
  }
  EXPECT_LT((published.pose().translation() - window.translation()).norm(), 1e-3);
}

TEST(PublishedPose, TheDecayDoesNotDependOnTheFrameRate) {
  const Eigen::Isometry3d target = pose({0.2, 0.0, 0.0}, {0.0, 0.0, 0.05});
  PublishedPose fast, slow;
  fast.start(Eigen::Isometry3d::Identity());
  slow.start(Eigen::Isometry3d::Identity());
  for (int i = 0; i < 10; ++i) fast.follow(target, target, 0.02);
  slow.follow(target, target, 0.2);
  EXPECT_LT((fast.pose().translation() - slow.pose().translation()).norm(), 1e-9);
  EXPECT_LT(angleBetween(fast.pose(), slow.pose()), 1e-9);
}

TEST(PublishedPose, MoveAndTurn) {
  PublishedPose published;
  published.start(pose({1.0, 0.0, 0.0}, {0.0, 0.0, M_PI / 2}));
  published.move(pose({2.0, 0.0, 0.0}, Eigen::Vector3d::Zero()));
  EXPECT_LT((published.pose().translation() - Eigen::Vector3d(1.0, 2.0, 0.0)).norm(), 1e-12);
  const Eigen::Vector3d before = published.pose().translation();
  published.turn(expSO3({0.1, 0.0, 0.0}));
  EXPECT_EQ(published.pose().translation(), before) << "gravity never moves the position";
}

TEST(PublishedPose, TheRotationStaysARotation) {
  PublishedPose published;
  Eigen::Isometry3d window = pose({0.0, 0.0, 0.0}, {0.1, 0.4, -0.2});
  published.start(Eigen::Isometry3d::Identity());
  for (int i = 0; i < 20000; ++i) {
    published.follow(window, window * kAdvance, kInterval);
    window = window * kAdvance;
    window.linear() = Eigen::Quaterniond(window.linear()).normalized().toRotationMatrix();
  }
  const Eigen::Matrix3d R = published.pose().linear();
  EXPECT_LT((R.transpose() * R - Eigen::Matrix3d::Identity()).norm(), 1e-12);
}

TEST(PublishedPose, CovarianceGrowsAsThePoseDoes) {
  // Against numeric differences: R_true = Exp(dtheta) R, positions additive.
  const Eigen::Isometry3d before = pose({1.0, 2.0, 3.0}, {0.3, -0.5, 1.0}),
                          step = pose({0.4, -0.2, 0.1}, {0.1, 0.2, -0.3});
  const auto disturbed = [](const Eigen::Isometry3d& T, const Eigen::Matrix<double, 6, 1>& d) {
    Eigen::Isometry3d result = T;
    result.translation() += d.head<3>();
    result.linear() = expSO3(d.tail<3>()) * T.linear();
    return result;
  };
  const Eigen::Isometry3d after = before * step;
  Matrix6d by_pose, by_motion;
  for (int c = 0; c < 6; ++c) {
    const Eigen::Matrix<double, 6, 1> d = 1e-6 * Eigen::Matrix<double, 6, 1>::Unit(c);
    for (Matrix6d* J : {&by_pose, &by_motion}) {
      const Eigen::Isometry3d T = J == &by_pose ? disturbed(before, d) * step : before * disturbed(step, d);
      J->col(c) << (T.translation() - after.translation()) / 1e-6,
          logSO3(T.linear() * after.linear().transpose()) / 1e-6;
    }
  }
  Matrix6d A = Matrix6d::Random(), B = Matrix6d::Random();
  const Matrix6d pose_covariance = A * A.transpose(), motion_covariance = B * B.transpose();
  const Matrix6d expected =
      by_pose * pose_covariance * by_pose.transpose() + by_motion * motion_covariance * by_motion.transpose();
  const Matrix6d found = propagateCovariance(pose_covariance, before, step, motion_covariance);
  EXPECT_LT((found - expected).norm(), 1e-5 * expected.norm());
}

TEST(TiltCorrection, IsLimitedInRateAndEndsUpright) {
  const double max_rate = 0.00873;
  Eigen::Matrix3d R = expSO3({0.03, -0.02, 0.5});
  // The vertical of a body whose attitude is off by 2 deg.
  const Eigen::Vector3d up = R.transpose() * expSO3({0.02, 0.025, 0.0}) * Eigen::Vector3d::UnitZ();
  double last = std::acos((R * up).z());
  for (int i = 0; i < 600; ++i) {
    const Eigen::Matrix3d turn = slowed(tiltCorrection(R, up, 0.0), max_rate, kInterval);
    EXPECT_LE(logSO3(turn).norm(), max_rate * kInterval * (1.0 + 1e-9));
    EXPECT_LT(std::abs(logSO3(turn).z()), 1e-12) << "yaw is not gravity's";
    R = turn * R;
    const double now = std::acos(std::min(1.0, (R * up).z()));
    EXPECT_LE(now, last + 1e-9);
    last = now;
  }
  EXPECT_LT(last, 1e-4);
  EXPECT_LT(logSO3(tiltCorrection(R, R.transpose() * Eigen::Vector3d::UnitZ(), 0.0)).norm(), 1e-9);
}

TEST(TiltCorrection, LeavesWhatIsWithinASigma) {
  const Eigen::Vector3d up = expSO3({0.02, 0.0, 0.0}) * Eigen::Vector3d::UnitZ();
  EXPECT_LT(logSO3(tiltCorrection(Eigen::Matrix3d::Identity(), up, 0.05)).norm(), 1e-12);
  EXPECT_NEAR(logSO3(tiltCorrection(Eigen::Matrix3d::Identity(), up, 0.015)).norm(), 0.005, 1e-9);
}

TEST(TiltCorrection, UpsideDownIsNoNaN) {
  const Eigen::Matrix3d turn = tiltCorrection(Eigen::Matrix3d::Identity(), -Eigen::Vector3d::UnitZ(), 0.01);
  EXPECT_TRUE(turn.allFinite());
  EXPECT_LT((turn.transpose() * turn - Eigen::Matrix3d::Identity()).norm(), 1e-12);
}

}  // namespace
}  // namespace multicam_egomotion
