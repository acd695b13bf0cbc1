// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "bag_runner/bag_rig.h"

#include <rosbag/view.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Imu.h>
#include <tf2_msgs/TFMessage.h>

#include <algorithm>
#include <cstdio>
#include <set>
#include <stdexcept>

#include "multicam_egomotion/ros/rig_from_topics.h"

namespace multicam_egomotion {
namespace {

std::set<std::string> topicsOf(const rosbag::Bag& bag) {
  rosbag::View view(bag);
  std::set<std::string> topics;
  for (const rosbag::ConnectionInfo* connection : view.getConnections()) topics.insert(connection->topic);
  return topics;
}

std::string match(const std::set<std::string>& present, const std::string& topic, const std::string& what) {
  for (const std::string& candidate : {topic, "/" + topic, topic + "/compressed", "/" + topic + "/compressed"}) {
    if (present.count(candidate) > 0) return candidate;
  }
  std::string list;
  for (const std::string& name : present) list += "\n  " + name;
  throw std::invalid_argument("no " + what + " in the bag on '" + topic + "'; its topics are:" + list);
}

}  // namespace

void matchTopics(const rosbag::Bag& bag, bool use_imu, bool need_infos, RigTopics* topics) {
  const std::set<std::string> present = topicsOf(bag);
  for (std::string& topic : topics->images) topic = match(present, topic, "images");
  if (need_infos) {
    for (std::string& topic : topics->camera_infos) topic = match(present, topic, "CameraInfo");
  }
  if (use_imu) topics->imu = match(present, topics->imu, "IMU data (without an IMU: use_imu: false)");
}

int camerasInBag(const rosbag::Bag& bag) {
  const std::set<std::string> present = topicsOf(bag);
  int cameras = 0;
  const auto has = [&](const std::string& topic) {
    return present.count(topic) + present.count("/" + topic) + present.count("/" + topic + "/compressed") > 0;
  };
  while (has("cam" + std::to_string(cameras) + "/image_raw")) ++cameras;
  return cameras;
}

RigSetup rigFromBag(const rosbag::Bag& bag, const Parameters& parameters, const RigTopics& topics) {
  std::vector<std::string> names = topics.camera_infos;
  names.insert(names.end(), {"/tf_static", "/tf", topics.imu});
  rosbag::View view(bag, rosbag::TopicQuery(names));
  std::vector<sensor_msgs::CameraInfo::ConstPtr> received(topics.camera_infos.size());
  std::string imu_frame;
  tf2::BufferCore tf;
  const bool use_imu = parameters.odometry.use_imu;

  for (const rosbag::MessageInstance& message : view) {
    if (const auto transforms = message.instantiate<tf2_msgs::TFMessage>()) {
      for (const auto& transform : transforms->transforms) {
        tf.setTransform(transform, "bag", message.getTopic() == "/tf_static");
      }
    } else if (const auto imu = message.instantiate<sensor_msgs::Imu>()) {
      if (!imu_frame.empty()) continue;
      imu_frame = imu->header.frame_id;
    } else if (const auto info = message.instantiate<sensor_msgs::CameraInfo>()) {
      const auto topic = std::find(topics.camera_infos.begin(), topics.camera_infos.end(), message.getTopic());
      auto& slot = received[topic - topics.camera_infos.begin()];
      if (slot != nullptr) continue;
      slot = info;
    }
    const bool complete = std::find(received.begin(), received.end(), nullptr) == received.end();
    if (!complete || (use_imu && imu_frame.empty())) continue;

    std::vector<sensor_msgs::CameraInfo> infos;
    for (const auto& info : received) infos.push_back(*info);
    std::vector<std::string> warnings;
    const std::optional<CameraRig> rig =
        rigFromCameraInfo(infos, parameters.node.images_rectified, parameters.node.camera_time_offset_s, tf,
                          topics.base_frame, &warnings);
    if (!rig) continue;
    RigSetup setup{*rig, parameters.imu};
    if (use_imu) {
      const std::optional<Eigen::Isometry3d> T_body_imu = mountingFromTf(tf, topics.base_frame, imu_frame);
      if (!T_body_imu) continue;
      setup.imu.frame_id = imu_frame;
      setup.imu.T_body_imu = *T_body_imu;
    }
    for (const std::string& warning : warnings) std::fprintf(stderr, "warning: %s\n", warning.c_str());
    return setup;
  }
  std::string frames;
  for (const auto& info : received) frames += " '" + (info ? info->header.frame_id : std::string("?")) + "'";
  if (use_imu) frames += " '" + imu_frame + "'";
  throw std::invalid_argument("the bag's CameraInfo and TF make no rig: expected TF from '" + topics.base_frame +
                              "' to" + frames + "; or give --rig");
}

}  // namespace multicam_egomotion
