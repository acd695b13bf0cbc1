// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <rosbag/message_instance.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/CompressedImage.h>
#include <sensor_msgs/Image.h>
#include <sensor_msgs/Imu.h>

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace multicam_egomotion {

/// One message of a bag on its way through the faults. The kinds that faults can change are decoded; all others pass as
/// they are. Messages are shared: whoever changes one copies it first.
struct RecordedMessage {
  std::string topic;
  ros::Time recorded;  ///< when it arrived in the original: what `from` and `to` of a fault refer to
  ros::Time arrival;   ///< when it arrives in the corrupted bag
  std::variant<sensor_msgs::ImageConstPtr, sensor_msgs::CompressedImageConstPtr, sensor_msgs::CameraInfoConstPtr,
               sensor_msgs::ImuConstPtr, std::shared_ptr<const rosbag::MessageInstance>>
      content;
};

/// What is in the bag that is being corrupted.
struct BagLayout {
  std::vector<std::string> images;        ///< topics of the cameras, raw or compressed, in alphabetical order
  std::vector<std::string> camera_infos;  ///< the same of their CameraInfo
  ros::Time begin, end;                   ///< arrival of the first and the last message
};

bool isImage(const RecordedMessage& message);  ///< raw or compressed
bool isCameraInfo(const RecordedMessage& message);
bool isImu(const RecordedMessage& message);

/// Index of the camera of an image or a CameraInfo by the order of its topic.
std::optional<int> cameraOf(const RecordedMessage& message, const BagLayout& layout);

/// Changes a copy of the header of an image, a CameraInfo or an IMU sample; other messages stay as they are.
void changeHeader(RecordedMessage* message, const std::function<void(std_msgs::Header*)>& change);

/// A message of a decoded kind, copied to be changed.
template <class Message>
boost::shared_ptr<Message> copyOf(const RecordedMessage& message) {
  return boost::make_shared<Message>(*std::get<boost::shared_ptr<const Message>>(message.content));
}

}  // namespace multicam_egomotion
