// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "bag_runner/bag_replay.h"

#include <rosbag/view.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <optional>
#include <stdexcept>

#include "bag_runner/bag_rig.h"
#include "bag_runner/progress_bar.h"
#include "multicam_egomotion/ros/data_clock.h"
#include "multicam_egomotion/ros/image_conversion.h"
#include "multicam_egomotion/ros/messages.h"

namespace multicam_egomotion {
namespace {

/// The image of a raw or compressed message; nothing, and counted, when it cannot be decoded.
std::optional<CameraImage> decode(const rosbag::MessageInstance& message, int camera, RunReport* report) {
  CameraImage image;
  image.camera = camera;
  try {
    if (const auto raw = message.instantiate<sensor_msgs::Image>()) {
      image.stamp_ns = toNanoseconds(raw->header.stamp);
      image.grey = greyPixels(*raw);
      return image;
    }
    if (const auto compressed = message.instantiate<sensor_msgs::CompressedImage>()) {
      image.stamp_ns = toNanoseconds(compressed->header.stamp);
      image.grey = greyPixels(*compressed);
      return image;
    }
  } catch (const std::invalid_argument& error) {
    if (report->undecodable_images == 0) {
      std::fprintf(stderr, "warning: %s: %s\n", message.getTopic().c_str(), error.what());
    }
  }
  ++report->undecodable_images;
  return std::nullopt;
}

/// The rig of CameraInfo and TF, with the topics as a node would subscribe to them.
RigFile asFile(const RigSetup& setup, const RigTopics& topics, bool has_imu) {
  const std::string compressed = "/compressed";
  RigFile file{setup.rig, topics.images, topics.camera_infos, topics.base_frame, has_imu, setup.imu};
  for (std::string& topic : file.image_topics) {
    const std::size_t end = topic.size() - std::min(topic.size(), compressed.size());
    if (topic.compare(end, compressed.size(), compressed) == 0) topic.resize(end);
  }
  if (has_imu) file.imu.topic = topics.imu;
  return file;
}

}  // namespace

BagReplay::BagReplay(const rosbag::Bag& bag, const Parameters& parameters, const std::string& imu_topic)
    : bag_(bag), use_imu_(parameters.odometry.use_imu) {
  std::optional<RigSetup> setup;
  const bool with_file = !parameters.node.rig_file.empty();
  if (with_file) {
    setup = loadRigSetup(parameters, &topics_);
    rig_file_ = loadRigFile(parameters.node.rig_file, parameters.node.rig_imu_file);
  } else {
    topics_ = defaultTopics(std::max(1, camerasInBag(bag)), parameters.node.base_frame);
  }
  if (!imu_topic.empty()) topics_.imu = imu_topic;
  matchTopics(bag, use_imu_, !with_file, &topics_);
  if (!setup) {
    setup = rigFromBag(bag, parameters, topics_);
    rig_file_ = asFile(*setup, topics_, use_imu_);
  }
  odometry_ = makeEgoMotion(*setup, parameters);
}

void BagReplay::play(const OnResult& on_result, RunReport* report, const OnImage& on_image,
                     const std::function<bool()>& stop) {
  odometry_->setStageObserver([report](const char* name) { report->stage(name); });
  std::vector<std::string> inputs = topics_.images;
  if (use_imu_) inputs.push_back(topics_.imu);
  rosbag::View view(bag_, rosbag::TopicQuery(inputs));
  ProgressBar progress(view.size());
  DataClock clock;
  ros::Time bag_time;
  // Topics rarely end together: less than a second of IMU data after the last image says nothing of the images.
  const ros::Time last_image = rosbag::View(bag_, rosbag::TopicQuery(topics_.images)).getEndTime();
  const bool images_end_early = view.getEndTime() - last_image > ros::Duration(1.0);
  for (const rosbag::MessageInstance& message : view) {
    if (stop && stop()) {
      report->interrupted = true;
      break;
    }
    progress.advance();
    bag_time = message.getTime();
    std::int64_t now_ns = 0;
    if (use_imu_ && message.getTopic() == topics_.imu) {
      const auto imu = message.instantiate<sensor_msgs::Imu>();
      if (imu == nullptr) throw std::invalid_argument("'" + topics_.imu + "': expected sensor_msgs/Imu");
      ++report->imu_samples;
      const ImuSample sample = toImuSample(*imu);
      now_ns = clock.advance(sample.stamp_ns);
      report->mark();
      odometry_->addImu(sample);
    } else {
      const auto begin = std::chrono::steady_clock::now();
      const auto topic = std::find(topics_.images.begin(), topics_.images.end(), message.getTopic());
      const std::optional<CameraImage> image =
          decode(message, static_cast<int>(topic - topics_.images.begin()), report);
      if (!image) continue;
      ++report->images;
      report->addDecodeTime(std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
      if (on_image) on_image(image->camera, image->stamp_ns);
      now_ns = clock.advance(image->stamp_ns);
      report->mark();
      odometry_->addImage(*image, now_ns);
    }
    for (const EgoMotionResult& result : odometry_->advance(now_ns)) on_result(result, bag_time);
    if (bag_time == last_image) report->messages = odometry_->faults();
  }
  if (images_end_early || report->interrupted) report->messages = odometry_->faults();
  report->mark();
  for (const EgoMotionResult& result : odometry_->finish()) on_result(result, bag_time);
}

}  // namespace multicam_egomotion
