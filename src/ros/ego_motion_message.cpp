// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "multicam_egomotion/ros/ego_motion_message.h"

#include <multicam_egomotion/EgoMotion.h>

namespace multicam_egomotion {

EgoMotionMessage toEgoMotionMessage(const EgoMotionResult& result, const FrameNames& frames) {
  EgoMotionMessage message;
  message.header.stamp = toRosTime(result.stamp_ns);
  message.header.frame_id = frames.previous();
  message.previous_stamp = toRosTime(result.previous_stamp_ns);
  message.child_frame_id = frames.base;
  switch (result.status) {
    case EgoMotionStatus::kInitializing:
      message.status = EgoMotionMessage::INITIALIZING;
      break;
    case EgoMotionStatus::kTracking:
      message.status = EgoMotionMessage::TRACKING;
      break;
    case EgoMotionStatus::kCoasting:
      message.status = EgoMotionMessage::COASTING;
      break;
    case EgoMotionStatus::kLost:
      message.status = EgoMotionMessage::LOST;
      break;
  }
  switch (result.scale_state) {
    case ScaleState::kNotApplicable:
      message.scale_state = EgoMotionMessage::SCALE_NOT_APPLICABLE;
      break;
    case ScaleState::kObservable:
      message.scale_state = EgoMotionMessage::SCALE_OBSERVABLE;
      break;
    case ScaleState::kWeak:
      message.scale_state = EgoMotionMessage::SCALE_WEAK;
      break;
    case ScaleState::kUnobservable:
      message.scale_state = EgoMotionMessage::SCALE_UNOBSERVABLE;
      break;
  }
  message.has_relative_pose = result.has_relative_pose;
  message.pose = toRosPose(result.T_previous_body);
  message.scale_sigma = result.scale_sigma;
  message.keyframe = result.keyframe;
  message.odom_epoch = result.odom_epoch;
  message.solver = result.solver;
  message.tracks = static_cast<std::uint32_t>(result.tracks);
  message.inliers = static_cast<std::uint32_t>(result.inliers);
  message.ransac_samples = static_cast<std::uint32_t>(result.ransac_samples);
  message.pixel_sigma = result.pixel_sigma;
  message.gyroscope_bias = toRosVector(result.gyroscope_bias);
  message.accelerometer_bias = toRosVector(result.accelerometer_bias);
  message.up = toRosVector(result.up);
  message.tilt_sigma = result.tilt_sigma;
  return message;
}

void writeEgoMotion(rosbag::Bag* bag, const std::string& topic, const ros::Time& time, const EgoMotionResult& result,
                    const FrameNames& frames) {
  bag->write(topic, time, toEgoMotionMessage(result, frames));
}

ros::Publisher advertiseEgoMotion(ros::NodeHandle& node, const std::string& topic, std::uint32_t queue_size) {
  return node.advertise<EgoMotionMessage>(topic, queue_size);
}

void publishEgoMotion(const ros::Publisher& publisher, const EgoMotionResult& result, const FrameNames& frames) {
  publisher.publish(toEgoMotionMessage(result, frames));
}

}  // namespace multicam_egomotion
