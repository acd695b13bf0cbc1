// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "multicam_egomotion/ros/publishers.h"

#include <cv_bridge/cv_bridge.h>
#include <sensor_msgs/PointCloud2.h>
#include <sensor_msgs/image_encodings.h>

#include <algorithm>
#include <cmath>

#include "multicam_egomotion/ros/ego_motion_message.h"
#include "multicam_egomotion/ros/feature_image.h"

namespace multicam_egomotion {

Publishers::Publishers(ros::NodeHandle node, const FrameNames& frames, const NodeOptions& options)
    : frames_(frames), options_(options), transport_(node) {
  odometry_ = node.advertise<nav_msgs::Odometry>("odometry", 50);
  relative_pose_ = node.advertise<nav_msgs::Odometry>("relative_pose", 50);
  ego_motion_ = advertiseEgoMotion(node, "ego_motion", 50);
  odometry_imu_ = node.advertise<nav_msgs::Odometry>("odometry_imu", 200);
  path_publisher_ = node.advertise<nav_msgs::Path>("path", 1);
  points_ = node.advertise<sensor_msgs::PointCloud2>("points", 2);
  calibration_ = node.advertise<Calibration>("calibration", 1, true);
  features_ = transport_.advertise("features", 2);
}

void Publishers::publish(const EgoMotionResult& result, const CameraRig& rig, const RecentImages& images) {
  if (result.has_pose) {
    const nav_msgs::Odometry odometry = toOdometry(result, frames_);
    odometry_.publish(odometry);
    publishTransforms(result);
    publishPath(result, odometry);
  }
  if (result.has_relative_pose) relative_pose_.publish(toRelativePose(result, frames_));
  publishEgoMotion(ego_motion_, result, frames_);
  if (options_.publish_points && result.has_relative_pose && points_.getNumSubscribers() > 0)
    points_.publish(toPointCloud(result, frames_));
  if (options_.publish_features && features_.getNumSubscribers() > 0 && !result.image_stamps_ns.empty()) {
    std_msgs::Header header;
    header.stamp = toRosTime(result.stamp_ns);
    header.frame_id = rig.camera(0).frame_id;
    const cv::Mat picture = drawFeatures(result, rig, images);
    features_.publish(cv_bridge::CvImage(header, sensor_msgs::image_encodings::BGR8, picture).toImageMsg());
  }
}

void Publishers::publishCalibration(const EgoMotion& odometry, std::int64_t stamp_ns) {
  if (const auto message = calibrations_.next(odometry, stamp_ns, frames_)) calibration_.publish(*message);
}

void Publishers::publishTransforms(const EgoMotionResult& result) {
  if (options_.publish_tf) broadcaster_.sendTransform(toTransform(result, frames_));
  if (options_.publish_previous_tf && result.has_relative_pose) {
    broadcaster_.sendTransform(toPreviousTransform(result, frames_));
  }
}

void Publishers::publishPath(const EgoMotionResult& result, const nav_msgs::Odometry& odometry) {
  constexpr double kPublishPeriodS = 0.5;
  const ros::Time stamp = odometry.header.stamp;
  if (result.odom_epoch != path_epoch_) {
    path_.poses.clear();
    path_epoch_ = result.odom_epoch;
  }
  const bool due =
      path_.poses.empty() || std::abs((stamp - path_.poses.back().header.stamp).toSec()) >= options_.path_period_s;
  if (!due) return;
  geometry_msgs::PoseStamped pose;
  pose.header = odometry.header;
  pose.pose = odometry.pose.pose;
  path_.header = odometry.header;
  path_.poses.push_back(pose);
  // Drops a tenth at once, so that the poses are not moved for each new one.
  const std::size_t limit = static_cast<std::size_t>(options_.path_length);
  if (path_.poses.size() > limit) path_.poses.erase(path_.poses.begin(), path_.poses.begin() + 1 + limit / 10);
  if (path_publisher_.getNumSubscribers() > 0 && std::abs((stamp - path_published_).toSec()) >= kPublishPeriodS) {
    path_publisher_.publish(path_);
    path_published_ = stamp;
  }
}

}  // namespace multicam_egomotion
