// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "multicam_egomotion/ros/rig_acquisition.h"

#include <ros/console.h>

#include "multicam_egomotion/ros/rig_from_topics.h"

namespace multicam_egomotion {
namespace {

void append(const std::string& text, std::string* list) { *list += (list->empty() ? "" : ", ") + text; }

}  // namespace

RigAcquisition::RigAcquisition(ros::NodeHandle node, const RigTopics& topics, const Parameters& parameters)
    : topics_(topics),
      parameters_(parameters),
      listener_(std::make_unique<tf2_ros::TransformListener>(tf_, node)),
      infos_(topics.camera_infos.size()) {
  for (std::size_t i = 0; i < topics_.camera_infos.size(); ++i) {
    const boost::function<void(const sensor_msgs::CameraInfoConstPtr&)> callback =
        [this, i](const sensor_msgs::CameraInfoConstPtr& info) { receive(i, info); };
    subscribers_.push_back(node.subscribe<sensor_msgs::CameraInfo>(topics_.camera_infos[i], 5, callback));
  }
}

void RigAcquisition::receive(std::size_t camera, const sensor_msgs::CameraInfoConstPtr& info) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (!built_) {
    infos_[camera] = info;
  } else if (!sameCalibration(*infos_[camera], *info)) {
    ++changes_;
  }
}

void RigAcquisition::setImuFrame(const std::string& frame_id) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (imu_frame_.empty()) imu_frame_ = frame_id;
}

std::optional<RigSetup> RigAcquisition::tryBuild(std::string* missing) {
  missing->clear();
  const std::lock_guard<std::mutex> lock(mutex_);
  std::vector<sensor_msgs::CameraInfo> infos;
  std::vector<std::string> frames;
  for (std::size_t i = 0; i < infos_.size(); ++i) {
    if (infos_[i] == nullptr) {
      const bool published = subscribers_[i].getNumPublishers() > 0;
      append("CameraInfo on " + subscribers_[i].getTopic() + (published ? "" : " (no publisher)"), missing);
    } else {
      infos.push_back(*infos_[i]);
      frames.push_back(infos_[i]->header.frame_id);
    }
  }
  const bool use_imu = parameters_.odometry.use_imu;
  if (use_imu && imu_frame_.empty()) {
    append("the first message on " + topics_.imu, missing);
  } else if (use_imu) {
    frames.push_back(imu_frame_);
  }
  for (const std::string& frame : frames) {
    if (!mountingFromTf(tf_, topics_.base_frame, frame)) append("TF " + topics_.base_frame + " -> " + frame, missing);
  }
  if (!missing->empty()) return std::nullopt;

  std::vector<std::string> warnings;
  std::optional<CameraRig> rig =
      rigFromCameraInfo(infos, parameters_.node.images_rectified, parameters_.node.camera_time_offset_s, tf_,
                        topics_.base_frame, &warnings);
  if (!rig) return std::nullopt;
  for (const std::string& warning : warnings) ROS_WARN("%s", warning.c_str());
  RigSetup setup{*rig, parameters_.imu};
  if (use_imu) {
    setup.imu.frame_id = imu_frame_;
    setup.imu.T_body_imu = *mountingFromTf(tf_, topics_.base_frame, imu_frame_);
  }
  built_ = true;
  listener_.reset();
  return setup;
}

std::uint64_t RigAcquisition::changes() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return changes_;
}

}  // namespace multicam_egomotion
