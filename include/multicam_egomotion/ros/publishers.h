// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <image_transport/image_transport.h>
#include <nav_msgs/Path.h>
#include <ros/node_handle.h>
#include <tf2_ros/transform_broadcaster.h>

#include "multicam_egomotion/geometry/camera_rig.h"
#include "multicam_egomotion/odometry/ego_motion_result.h"
#include "multicam_egomotion/ros/calibration_message.h"
#include "multicam_egomotion/ros/messages.h"
#include "multicam_egomotion/ros/node_options.h"
#include "multicam_egomotion/ros/recent_images.h"

namespace multicam_egomotion {

/// All outputs on topics and TF. Those that cost something are made only while someone subscribes.
class Publishers {
 public:
  Publishers(ros::NodeHandle node, const FrameNames& frames, const NodeOptions& options);

  void publish(const EgoMotionResult& result, const CameraRig& rig, const RecentImages& images);
  /// With each result; published when it is time.
  void publishCalibration(const EgoMotion& odometry, std::int64_t stamp_ns);

  /// Pictures for people, which may be switched while running.
  void show(bool features, bool points) {
    options_.publish_features = features;
    options_.publish_points = points;
  }

  bool wantsImuOdometry() const { return odometry_imu_.getNumSubscribers() > 0; }
  void publishImuOdometry(const EgoMotionResult& result) { odometry_imu_.publish(toOdometry(result, frames_)); }

 private:
  void publishTransforms(const EgoMotionResult& result);
  void publishPath(const EgoMotionResult& result, const nav_msgs::Odometry& odometry);

  const FrameNames frames_;
  NodeOptions options_;
  image_transport::ImageTransport transport_;
  ros::Publisher odometry_, relative_pose_, ego_motion_, odometry_imu_, path_publisher_, points_, calibration_;
  image_transport::Publisher features_;
  tf2_ros::TransformBroadcaster broadcaster_;

  CalibrationMessages calibrations_;
  nav_msgs::Path path_;
  std::uint32_t path_epoch_ = 0;
  ros::Time path_published_;
};

}  // namespace multicam_egomotion
