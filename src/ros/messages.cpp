// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "multicam_egomotion/ros/messages.h"

#include <sensor_msgs/point_cloud2_iterator.h>
#include <tf2_eigen/tf2_eigen.h>

#include <algorithm>
#include <cmath>

#include "multicam_egomotion/geometry/covariance.h"

namespace multicam_egomotion {
namespace {

constexpr double kSmallestVariance = 1e-10, kLargestVariance = 1e6;
constexpr double kSmallestEigenvalue = 1e-12;
constexpr double kSmallestShare = 1e-13;  // of the largest eigenvalue: positive definite in double precision

void setTwist(const EgoMotionResult& result, nav_msgs::Odometry* message) {
  message->twist.twist.linear = toRosVector(result.twist.linear);
  message->twist.twist.angular = toRosVector(result.twist.angular);
  message->twist.covariance = toRosCovariance(result.twist.covariance);
}

/// With the numbers of the pose message: the same quaternion of the two that mean the rotation.
geometry_msgs::TransformStamped toTransformMessage(const Eigen::Isometry3d& T_parent_child, std::int64_t stamp_ns,
                                                   const std::string& parent, const std::string& child) {
  const geometry_msgs::Pose pose = tf2::toMsg(T_parent_child);
  geometry_msgs::TransformStamped message;
  message.header.stamp = toRosTime(stamp_ns);
  message.header.frame_id = parent;
  message.child_frame_id = child;
  message.transform.translation = toRosVector(T_parent_child.translation());
  message.transform.rotation = pose.orientation;
  return message;
}

}  // namespace

geometry_msgs::Vector3 toRosVector(const Eigen::Vector3d& v) {
  geometry_msgs::Vector3 message;
  message.x = v.x();
  message.y = v.y();
  message.z = v.z();
  return message;
}

geometry_msgs::PoseWithCovariance toRosPose(const PoseWithCovariance& pose) {
  geometry_msgs::PoseWithCovariance message;
  message.pose = tf2::toMsg(pose.pose);
  message.covariance = toRosCovariance(pose.covariance);
  return message;
}

ros::Time toRosTime(std::int64_t stamp_ns) {
  ros::Time time;
  if (stamp_ns > 0) time.fromNSec(static_cast<std::uint64_t>(stamp_ns));
  return time;
}

std::int64_t toNanoseconds(const ros::Time& time) { return static_cast<std::int64_t>(time.toNSec()); }

boost::array<double, 36> toRosCovariance(const Matrix6d& covariance) {
  Matrix6d result = Matrix6d::Identity() * kLargestVariance;
  if (covariance.allFinite()) {
    // Positive definite, then the scale of each axis is limited: what the axes have in common stays.
    result = withEigenvaluesRaised(covariance, kSmallestEigenvalue, kSmallestShare);
    const Eigen::Matrix<double, 6, 1> variances = result.diagonal();
    const Eigen::Matrix<double, 6, 1> scale =
        (variances.array().max(kSmallestVariance).min(kLargestVariance) / variances.array()).sqrt();
    result = scale.asDiagonal() * result * scale.asDiagonal();
    result = (0.5 * (result + result.transpose())).eval();
    result.diagonal() = result.diagonal().cwiseMax(kSmallestVariance).cwiseMin(kLargestVariance).eval();
  }
  boost::array<double, 36> values;
  std::copy_n(result.data(), 36, values.begin());
  return values;
}

nav_msgs::Odometry toOdometry(const EgoMotionResult& result, const FrameNames& frames) {
  nav_msgs::Odometry message;
  message.header.stamp = toRosTime(result.stamp_ns);
  message.header.frame_id = frames.odom;
  message.child_frame_id = frames.base;
  message.pose = toRosPose(result.T_odom_body);
  setTwist(result, &message);
  return message;
}

nav_msgs::Odometry toRelativePose(const EgoMotionResult& result, const FrameNames& frames) {
  nav_msgs::Odometry message;
  message.header.stamp = toRosTime(result.stamp_ns);
  message.header.frame_id = frames.previous();
  message.child_frame_id = frames.base;
  message.pose = toRosPose(result.T_previous_body);
  setTwist(result, &message);
  return message;
}

geometry_msgs::TransformStamped toTransform(const EgoMotionResult& result, const FrameNames& frames) {
  return toTransformMessage(result.T_odom_body.pose, result.stamp_ns, frames.odom, frames.base);
}

geometry_msgs::TransformStamped toPreviousTransform(const EgoMotionResult& result, const FrameNames& frames) {
  return toTransformMessage(result.T_previous_body.pose.inverse(), result.stamp_ns, frames.base, frames.previous());
}

sensor_msgs::PointCloud2 toPointCloud(const EgoMotionResult& result, const FrameNames& frames) {
  sensor_msgs::PointCloud2 message;
  message.header.stamp = toRosTime(result.stamp_ns);
  message.header.frame_id = frames.odom;
  message.is_dense = true;
  sensor_msgs::PointCloud2Modifier modifier(message);
  modifier.setPointCloud2FieldsByString(1, "xyz");
  modifier.resize(result.points.size());
  if (result.points.empty()) return message;  // the iterators take the address of the first byte
  sensor_msgs::PointCloud2Iterator<float> x(message, "x"), y(message, "y"), z(message, "z");
  for (const Eigen::Vector3d& point : result.points) {
    *x = static_cast<float>(point.x());
    *y = static_cast<float>(point.y());
    *z = static_cast<float>(point.z());
    ++x, ++y, ++z;
  }
  return message;
}

ImuSample toImuSample(const sensor_msgs::Imu& message) {
  ImuSample sample;
  sample.stamp_ns = toNanoseconds(message.header.stamp);
  sample.angular_velocity = {message.angular_velocity.x, message.angular_velocity.y, message.angular_velocity.z};
  sample.linear_acceleration = {message.linear_acceleration.x, message.linear_acceleration.y,
                                message.linear_acceleration.z};
  const Eigen::Vector4d q(message.orientation.x, message.orientation.y, message.orientation.z, message.orientation.w);
  const double variance = std::max(message.orientation_covariance[0], message.orientation_covariance[4]);
  if (message.orientation_covariance[0] >= 0.0 && variance > 0.0 && std::abs(q.norm() - 1.0) < 0.01) {
    sample.orientation_xyzw = q.normalized();
    sample.orientation_sigma = std::sqrt(variance);
  }
  return sample;
}

Eigen::Isometry3d toIsometry(const geometry_msgs::Pose& pose) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation() << pose.position.x, pose.position.y, pose.position.z;
  const geometry_msgs::Quaternion& q = pose.orientation;
  T.linear() = Eigen::Quaterniond(q.w, q.x, q.y, q.z).normalized().toRotationMatrix();
  return T;
}

bool isRigid(const geometry_msgs::Pose& pose) {
  const geometry_msgs::Point& p = pose.position;
  const geometry_msgs::Quaternion& q = pose.orientation;
  const double norm = Eigen::Vector4d(q.x, q.y, q.z, q.w).norm();
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z) && std::abs(norm - 1.0) < 0.01;
}

}  // namespace multicam_egomotion
