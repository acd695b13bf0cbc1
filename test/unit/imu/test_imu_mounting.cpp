// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>

#include "multicam_egomotion/geometry/so3.h"
#include "multicam_egomotion/imu/imu_mounting.h"

namespace multicam_egomotion {
namespace {

Eigen::Isometry3d mounting() {
  Eigen::Isometry3d T_body_imu = Eigen::Isometry3d::Identity();
  T_body_imu.linear() = expSO3(Eigen::Vector3d(0.4, -1.1, 2.0));
  T_body_imu.translation() << 0.3, -0.2, 0.5;
  return T_body_imu;
}

TEST(LevelAttitude, PutsBodyXIntoTheVerticalPlaneOfOdomX) {
  for (const Eigen::Vector3d& up : {Eigen::Vector3d(0, 0, 2), Eigen::Vector3d(0.3, -0.5, 0.8),
                                    Eigen::Vector3d(0.2, 1, 0), Eigen::Vector3d(-0.5, 0.1, -1)}) {
    const Eigen::Matrix3d R = levelAttitude(up);
    EXPECT_TRUE(R.isUnitary(1e-12));
    EXPECT_NEAR(R.determinant(), 1, 1e-12);
    EXPECT_TRUE((R * up.normalized()).isApprox(Eigen::Vector3d::UnitZ(), 1e-12));
    EXPECT_NEAR((R * Eigen::Vector3d::UnitX()).y(), 0, 1e-12);
    EXPECT_GT((R * Eigen::Vector3d::UnitX()).x(), 0);
  }
}

TEST(LevelAttitude, TakesTheShortestArcWhenBodyXIsNearVertical) {
  for (const Eigen::Vector3d& up : {Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(-1, 0.2, 0.1)}) {
    const Eigen::Matrix3d R = levelAttitude(up);
    EXPECT_TRUE((R * up.normalized()).isApprox(Eigen::Vector3d::UnitZ(), 1e-12));
    EXPECT_NEAR(logSO3(R).norm(), std::acos(up.normalized().z()), 1e-9);
  }
}

TEST(ShortestArc, TurnsOneDirectionIntoTheOther) {
  const Eigen::Vector3d from(1, 2, 3);
  for (const Eigen::Vector3d& to : {Eigen::Vector3d(1, 2, 3), Eigen::Vector3d(-1, -2, -3), Eigen::Vector3d(0, 1, 0),
                                    Eigen::Vector3d(1, 2, 3.000001)}) {
    EXPECT_TRUE((expSO3(shortestArc(from, to)) * from.normalized()).isApprox(to.normalized(), 1e-9));
  }
}

TEST(LeverArm, VelocityMatchesTheMotionOfARigidBody) {
  const Eigen::Isometry3d T_body_imu = mounting();
  const Eigen::Vector3d rate_body(0.5, -0.8, 1.1), velocity_body(2, -1, 0.4);  // body axes
  const double h = 1e-6;
  Eigen::Isometry3d T_now_later = Eigen::Isometry3d::Identity();
  T_now_later.linear() = expSO3(h * rate_body);
  T_now_later.translation() = h * velocity_body;
  const Eigen::Isometry3d T_imu = imuRelativePose(T_body_imu, T_now_later);
  const Eigen::Vector3d rate_imu = T_body_imu.linear().transpose() * rate_body;
  const Eigen::Vector3d velocity_imu = imuVelocity(T_body_imu, velocity_body, rate_imu);
  EXPECT_LT((T_imu.translation() / h - velocity_imu).norm(), 1e-5);
  EXPECT_LT((logSO3(T_imu.linear()) / h - rate_imu).norm(), 1e-5);
  EXPECT_TRUE(bodyVelocity(T_body_imu, velocity_imu, rate_imu).isApprox(velocity_body, 1e-12));
}

TEST(LeverArm, RelativePosesAreInverses) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = expSO3(Eigen::Vector3d(0.1, 0.2, -0.3));
  T.translation() << 1, 2, 3;
  EXPECT_TRUE(bodyRelativePose(mounting(), imuRelativePose(mounting(), T)).isApprox(T, 1e-12));
  EXPECT_FALSE(imuRelativePose(mounting(), T).isApprox(T, 1e-3));
}

}  // namespace
}  // namespace multicam_egomotion
