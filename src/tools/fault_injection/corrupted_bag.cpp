// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "fault_injection/corrupted_bag.h"

#include <rosbag/bag.h>
#include <rosbag/view.h>

#include <algorithm>
#include <filesystem>
#include <stdexcept>

namespace multicam_egomotion {
namespace {

constexpr const char* kImage = "sensor_msgs/Image";
constexpr const char* kCompressedImage = "sensor_msgs/CompressedImage";
constexpr const char* kCameraInfo = "sensor_msgs/CameraInfo";
constexpr const char* kImu = "sensor_msgs/Imu";

BagLayout layoutOf(rosbag::View& view) {
  BagLayout layout;
  for (const rosbag::ConnectionInfo* connection : view.getConnections()) {
    const bool image = connection->datatype == kImage || connection->datatype == kCompressedImage;
    if (image) layout.images.push_back(connection->topic);
    if (connection->datatype == kCameraInfo) layout.camera_infos.push_back(connection->topic);
  }
  for (std::vector<std::string>* topics : {&layout.images, &layout.camera_infos}) {
    std::sort(topics->begin(), topics->end());
    topics->erase(std::unique(topics->begin(), topics->end()), topics->end());
  }
  if (view.size() > 0) {
    layout.begin = view.getBeginTime();
    layout.end = view.getEndTime();
  }
  return layout;
}

RecordedMessage decode(const rosbag::MessageInstance& message) {
  RecordedMessage decoded;
  decoded.topic = message.getTopic();
  decoded.recorded = decoded.arrival = message.getTime();
  const std::string& type = message.getDataType();
  if (type == kImage) {
    decoded.content = sensor_msgs::ImageConstPtr(message.instantiate<sensor_msgs::Image>());
  } else if (type == kCompressedImage) {
    decoded.content = sensor_msgs::CompressedImageConstPtr(message.instantiate<sensor_msgs::CompressedImage>());
  } else if (type == kCameraInfo) {
    decoded.content = sensor_msgs::CameraInfoConstPtr(message.instantiate<sensor_msgs::CameraInfo>());
  } else if (type == kImu) {
    decoded.content = sensor_msgs::ImuConstPtr(message.instantiate<sensor_msgs::Imu>());
  } else {
    decoded.content = std::make_shared<const rosbag::MessageInstance>(message);
  }
  return decoded;
}

void write(rosbag::Bag* bag, const RecordedMessage& message) {
  std::visit(
      [&](const auto& content) {
        if constexpr (std::is_same_v<std::decay_t<decltype(*content)>, rosbag::MessageInstance>) {
          bag->write(message.topic, message.arrival, *content, content->getConnectionHeader());
        } else {
          bag->write(message.topic, message.arrival, *content);
        }
      },
      message.content);
}

void expectCamera(const FaultRequest& fault, const BagLayout& layout) {
  for (const FaultParameter& parameter : fault.kind->parameters) {
    if (parameter.name != "camera") continue;
    const int camera = fault.values.integer("camera");
    const int cameras = static_cast<int>(layout.images.size());
    if (camera < cameras) continue;
    throw std::invalid_argument("fault " + fault.kind->name + ": camera is " + std::to_string(camera) +
                                ", expected less than " + std::to_string(cameras) +
                                ", the number of image topics in the bag");
  }
}

bool sameFile(const std::string& a, const std::string& b) {
  std::error_code missing;
  return a == b || std::filesystem::equivalent(a, b, missing);
}

}  // namespace

void corruptBag(const std::string& input, const std::string& output, const std::vector<FaultRequest>& faults,
                std::uint64_t seed) {
  if (sameFile(input, output)) {
    throw std::invalid_argument("found '" + output + "' as input and output, expected two files");
  }
  rosbag::Bag in(input, rosbag::bagmode::Read);
  rosbag::View view(in);
  const BagLayout layout = layoutOf(view);
  std::vector<Fault> chain;
  for (const FaultRequest& fault : faults) {
    expectCamera(fault, layout);
    chain.push_back(fault.kind->make({fault.values, layout, seed + chain.size()}));
  }

  rosbag::Bag out(output, rosbag::bagmode::Write);
  out.setCompression(rosbag::compression::LZ4);
  const std::function<void(std::size_t, RecordedMessage)> pass = [&](std::size_t stage, RecordedMessage message) {
    if (stage == chain.size()) {
      write(&out, message);
    } else {
      chain[stage](std::move(message), [&pass, stage](RecordedMessage next) { pass(stage + 1, std::move(next)); });
    }
  };
  for (const rosbag::MessageInstance& message : view) pass(0, decode(message));
  out.close();
}

}  // namespace multicam_egomotion
