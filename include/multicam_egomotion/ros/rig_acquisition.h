// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/node_handle.h>
#include <sensor_msgs/CameraInfo.h>
#include <tf2_ros/transform_listener.h>

#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "multicam_egomotion/ros/rig_setup.h"

namespace multicam_egomotion {

/// Builds the rig from CameraInfo topics and TF as they arrive (contract 11), and afterwards watches that CameraInfo
/// does not change. Callbacks and the worker may use it at the same time.
class RigAcquisition {
 public:
  RigAcquisition(ros::NodeHandle node, const RigTopics& topics, const Parameters& parameters);

  /// The IMU's frame is known from its first message.
  void setImuFrame(const std::string& frame_id);

  /// The rig, once everything is there; until then `missing` says what is not. Throws std::invalid_argument on
  /// calibrations that cannot be.
  std::optional<RigSetup> tryBuild(std::string* missing);

  /// CameraInfo messages that differ from those the rig was built of.
  std::uint64_t changes() const;

 private:
  void receive(std::size_t camera, const sensor_msgs::CameraInfoConstPtr& info);

  const RigTopics topics_;
  const Parameters parameters_;
  tf2_ros::Buffer tf_;
  std::unique_ptr<tf2_ros::TransformListener> listener_;  // until the rig is built
  std::vector<ros::Subscriber> subscribers_;

  mutable std::mutex mutex_;
  std::vector<sensor_msgs::CameraInfoConstPtr> infos_;
  std::string imu_frame_;
  bool built_ = false;
  std::uint64_t changes_ = 0;
};

}  // namespace multicam_egomotion
