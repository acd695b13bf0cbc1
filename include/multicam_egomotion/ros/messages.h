// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <geometry_msgs/PoseWithCovariance.h>
#include <geometry_msgs/TransformStamped.h>
#include <geometry_msgs/Vector3.h>
#include <nav_msgs/Odometry.h>
#include <ros/time.h>
#include <sensor_msgs/Imu.h>
#include <sensor_msgs/PointCloud2.h>

#include <boost/array.hpp>
#include <cstdint>
#include <string>

#include "multicam_egomotion/imu/imu_sample.h"
#include "multicam_egomotion/odometry/ego_motion_result.h"

namespace multicam_egomotion {

/// Names of the frames that the messages connect.
struct FrameNames {
  std::string odom = "odom";
  std::string base = "base_link";
  std::string previous() const { return base + "_previous"; }
};

ros::Time toRosTime(std::int64_t stamp_ns);  ///< negative stamps become 0
std::int64_t toNanoseconds(const ros::Time& time);

/// Row-major covariance for a message: symmetric, positive definite, variances within [1e-10, 1e6]; a matrix that is
/// not finite becomes the widest (contract 10).
boost::array<double, 36> toRosCovariance(const Matrix6d& covariance);

/// Pose of the body in odom, twist in body axes; stamp of the frame set.
nav_msgs::Odometry toOdometry(const EgoMotionResult& result, const FrameNames& frames);

/// Pose of body(t2) in body(t1) with header frame `<base>_previous`; the twist is that of toOdometry.
nav_msgs::Odometry toRelativePose(const EgoMotionResult& result, const FrameNames& frames);

/// odom -> base.
geometry_msgs::TransformStamped toTransform(const EgoMotionResult& result, const FrameNames& frames);
/// base -> <base>_previous, body(t1) in body(t2).
geometry_msgs::TransformStamped toPreviousTransform(const EgoMotionResult& result, const FrameNames& frames);

/// Landmarks in odom, xyz float32.
sensor_msgs::PointCloud2 toPointCloud(const EgoMotionResult& result, const FrameNames& frames);

/// With the tilt sigma of the message's orientation: the larger of its roll and pitch sigmas; negative when the message
/// carries no orientation (covariance[0] = -1), a zero quaternion or a zero covariance.
ImuSample toImuSample(const sensor_msgs::Imu& message);

geometry_msgs::PoseWithCovariance toRosPose(const PoseWithCovariance& pose);
geometry_msgs::Vector3 toRosVector(const Eigen::Vector3d& vector);

Eigen::Isometry3d toIsometry(const geometry_msgs::Pose& pose);  ///< normalizes the quaternion
bool isRigid(const geometry_msgs::Pose& pose);                  ///< finite, with a quaternion of norm 1 to 1 %

}  // namespace multicam_egomotion
