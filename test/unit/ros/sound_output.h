// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <vector>

#include "multicam_egomotion/odometry/ego_motion_result.h"
#include "multicam_egomotion/ros/messages.h"

namespace multicam_egomotion {

inline bool allFinite(const geometry_msgs::Vector3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

inline bool symmetricPositiveDefinite(const boost::array<double, 36>& values) {
  const Matrix6d covariance = Eigen::Map<const Matrix6d>(values.data());
  return covariance.allFinite() && covariance == covariance.transpose() && covariance.llt().info() == Eigen::Success &&
         covariance.diagonal().minCoeff() >= 1e-10 && covariance.diagonal().maxCoeff() <= 1e6;
}

inline void expectPublishable(const nav_msgs::Odometry& message) {
  EXPECT_TRUE(isRigid(message.pose.pose)) << message;
  EXPECT_TRUE(allFinite(message.twist.twist.linear) && allFinite(message.twist.twist.angular)) << message;
  EXPECT_TRUE(symmetricPositiveDefinite(message.pose.covariance)) << message;
  EXPECT_TRUE(symmetricPositiveDefinite(message.twist.covariance)) << message;
}

/// What holds of everything that leaves the odometry, whatever came in: no NaN or infinity, covariances symmetric
/// positive definite, and no stale pose published as fresh: stamps rise within an odom epoch, unless `stamps_jump`; a
/// pose that is not called coasting belongs to an image of its stamp; a coasting one grows more uncertain and ends
/// after `max_coast_s`; none repeats the one before.
inline void expectSoundOutput(const std::vector<EgoMotionResult>& results, double max_coast_s, bool stamps_jump) {
  const FrameNames frames;
  const EgoMotionResult* previous = nullptr;  // with a pose
  std::int64_t vision_ns = 0;
  for (const EgoMotionResult& result : results) {
    SCOPED_TRACE("result at " + std::to_string(result.stamp_ns));
    EXPECT_GT(result.stamp_ns, 0);
    EXPECT_FALSE(std::isnan(result.scale_sigma));
    EXPECT_NEAR(result.up.norm(), 1.0, 1e-9);
    EXPECT_TRUE(std::isfinite(result.tilt_sigma) && std::isfinite(result.pixel_sigma));
    EXPECT_TRUE(result.gyroscope_bias.allFinite() && result.accelerometer_bias.allFinite());
    for (const Eigen::Vector3d& point : result.points) EXPECT_TRUE(point.allFinite());
    if (result.has_relative_pose) expectPublishable(toRelativePose(result, frames));
    EXPECT_FALSE(result.has_pose && result.status == EgoMotionStatus::kLost);
    if (!result.has_pose) continue;
    expectPublishable(toOdometry(result, frames));

    const auto& stamps = result.image_stamps_ns;
    const bool of_image = std::find(stamps.begin(), stamps.end(), result.stamp_ns) != stamps.end();
    const bool coasting = result.status == EgoMotionStatus::kCoasting;
    EXPECT_TRUE(of_image || coasting);
    EXPECT_TRUE(result.status != EgoMotionStatus::kTracking || result.inliers > 0);
    const bool same_epoch = previous != nullptr && previous->odom_epoch == result.odom_epoch;
    const bool went_back = same_epoch && result.stamp_ns <= previous->stamp_ns;
    EXPECT_TRUE(!went_back || stamps_jump) << "after " << previous->stamp_ns;
    if (!coasting || !same_epoch || went_back) vision_ns = result.stamp_ns;
    EXPECT_LE(1e-9 * static_cast<double>(result.stamp_ns - vision_ns), max_coast_s + 1e-6);
    if (same_epoch && !went_back) {
      const Matrix6d& before = previous->T_odom_body.covariance;
      const Matrix6d& now = result.T_odom_body.covariance;
      EXPECT_FALSE(now == before && result.T_odom_body.pose.matrix() == previous->T_odom_body.pose.matrix());
      // On the way back to the start, what the tilt did to the position is undone.
      EXPECT_TRUE(!coasting || now.trace() >= 0.99 * before.trace()) << now.trace() << " < " << before.trace();
    }
    previous = &result;
  }
}

}  // namespace multicam_egomotion
