// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "fault_injection/recorded_message.h"

#include <algorithm>
#include <boost/make_shared.hpp>

namespace multicam_egomotion {

bool isImage(const RecordedMessage& message) {
  return std::holds_alternative<sensor_msgs::ImageConstPtr>(message.content) ||
         std::holds_alternative<sensor_msgs::CompressedImageConstPtr>(message.content);
}

bool isCameraInfo(const RecordedMessage& message) {
  return std::holds_alternative<sensor_msgs::CameraInfoConstPtr>(message.content);
}

bool isImu(const RecordedMessage& message) { return std::holds_alternative<sensor_msgs::ImuConstPtr>(message.content); }

std::optional<int> cameraOf(const RecordedMessage& message, const BagLayout& layout) {
  if (!isImage(message) && !isCameraInfo(message)) return std::nullopt;
  const std::vector<std::string>& topics = isImage(message) ? layout.images : layout.camera_infos;
  const auto topic = std::find(topics.begin(), topics.end(), message.topic);
  if (topic == topics.end()) return std::nullopt;
  return static_cast<int>(topic - topics.begin());
}

void changeHeader(RecordedMessage* message, const std::function<void(std_msgs::Header*)>& change) {
  const auto changed = [&](auto copy) {
    change(&copy->header);
    message->content = copy;
  };
  if (std::holds_alternative<sensor_msgs::ImageConstPtr>(message->content)) {
    changed(copyOf<sensor_msgs::Image>(*message));
  } else if (std::holds_alternative<sensor_msgs::CompressedImageConstPtr>(message->content)) {
    changed(copyOf<sensor_msgs::CompressedImage>(*message));
  } else if (isCameraInfo(*message)) {
    changed(copyOf<sensor_msgs::CameraInfo>(*message));
  } else if (isImu(*message)) {
    changed(copyOf<sensor_msgs::Imu>(*message));
  }
}

}  // namespace multicam_egomotion
