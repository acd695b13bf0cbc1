// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
// Odometry of a recorded bag without a roscore: the class and the parameters of the nodelet, as fast as the machine
// can. Exit code 1 on failure, 2 when there was no pose.
#include <rosbag/view.h>
#include <tf2_msgs/TFMessage.h>

#include <algorithm>
#include <cstdio>
#include <optional>
#include <stdexcept>

#include "bag_runner/bag_rig.h"
#include "bag_runner/command_line.h"
#include "bag_runner/progress_bar.h"
#include "bag_runner/run_report.h"
#include "bag_runner/trajectory_files.h"
#include "multicam_egomotion/ros/data_clock.h"
#include "multicam_egomotion/ros/ego_motion_message.h"
#include "multicam_egomotion/ros/image_conversion.h"

namespace multicam_egomotion {
namespace {

/// The files that were asked for, filled result by result.
struct Outputs {
  Outputs(const BagCommand& command, const Eigen::Isometry3d& T_body_cam0, const FrameNames& names) : frames(names) {
    if (!command.trajectory.empty()) tum.emplace(command.trajectory);
    if (!command.kitti.empty()) kitti.emplace(command.kitti, T_body_cam0);
    if (!command.output_bag.empty()) bag.emplace(command.output_bag, rosbag::bagmode::Write);
  }

  void write(const EgoMotionResult& result, const ros::Time& time, RunReport* report) {
    report->addResult(result);
    const auto& stamps = result.image_stamps_ns;
    const bool of_images = std::any_of(stamps.begin(), stamps.end(), [](std::int64_t stamp) { return stamp != 0; });
    if (result.has_pose && of_images) {
      ++report->poses;
      if (tum) tum->write(result.stamp_ns, result.T_odom_body.pose);
      if (kitti && stamps[0] != 0) kitti->addPose(stamps[0], result.T_odom_body.pose);
    }
    if (!bag) return;
    writeEgoMotion(&*bag, "ego_motion", time, result, frames);
    if (result.has_relative_pose) bag->write("relative_pose", time, toRelativePose(result, frames));
    if (!result.has_pose) return;
    bag->write("odometry", time, toOdometry(result, frames));
    tf2_msgs::TFMessage transforms;
    transforms.transforms.push_back(toTransform(result, frames));
    bag->write("/tf", time, transforms);
  }

  void close() {
    if (tum) tum->close();
    if (kitti) kitti->close();
    if (bag) bag->close();
  }

  FrameNames frames;
  std::optional<TumFile> tum;
  std::optional<KittiFile> kitti;
  std::optional<rosbag::Bag> bag;
};

Parameters readParameters(const BagCommand& command) {
  Parameters parameters;
  if (!command.config.empty()) {
    for (const std::string& name : applyParameters(readParameterFile(command.config), &parameters)) {
      throw std::invalid_argument(command.config + ": '" + name + "' is no parameter of multicam_egomotion");
    }
  }
  if (!command.rig.empty()) parameters.node.rig_file = command.rig;
  if (!command.rig_imu.empty()) parameters.node.rig_imu_file = command.rig_imu;
  return parameters;
}

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

int run(const BagCommand& command) {
  Parameters parameters = readParameters(command);
  rosbag::Bag bag(command.bag, rosbag::bagmode::Read);
  RigTopics topics;
  std::optional<RigSetup> setup;
  const bool use_imu = parameters.odometry.use_imu;
  const bool with_file = !parameters.node.rig_file.empty();
  if (with_file) {
    setup = loadRigSetup(parameters, &topics);
  } else {
    topics = defaultTopics(std::max(1, camerasInBag(bag)), parameters.node.base_frame);
  }
  if (!command.imu_topic.empty()) topics.imu = command.imu_topic;
  matchTopics(bag, use_imu, !with_file, &topics);
  if (!setup) setup = rigFromBag(bag, parameters, topics);

  const auto odometry = makeEgoMotion(*setup, parameters);
  Outputs outputs(command, setup->rig.camera(0).T_body_cam, {parameters.node.odom_frame, topics.base_frame});
  RunReport report;
  odometry->setStageObserver([&report](const char* name) { report.stage(name); });

  std::vector<std::string> inputs = topics.images;
  if (use_imu) inputs.push_back(topics.imu);
  rosbag::View view(bag, rosbag::TopicQuery(inputs));
  ProgressBar progress(view.size());
  DataClock clock;
  ros::Time bag_time;
  for (const rosbag::MessageInstance& message : view) {
    progress.advance();
    bag_time = message.getTime();
    std::int64_t now_ns = 0;
    if (use_imu && message.getTopic() == topics.imu) {
      const auto imu = message.instantiate<sensor_msgs::Imu>();
      if (imu == nullptr) throw std::invalid_argument("'" + topics.imu + "': expected sensor_msgs/Imu");
      ++report.imu_samples;
      const ImuSample sample = toImuSample(*imu);
      now_ns = clock.advance(sample.stamp_ns);
      report.mark();
      odometry->addImu(sample);
    } else {
      const auto begin = std::chrono::steady_clock::now();
      const auto topic = std::find(topics.images.begin(), topics.images.end(), message.getTopic());
      const std::optional<CameraImage> image =
          decode(message, static_cast<int>(topic - topics.images.begin()), &report);
      if (!image) continue;
      ++report.images;
      report.addDecodeTime(std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
      if (outputs.kitti && image->camera == 0) outputs.kitti->addImage(image->stamp_ns);
      now_ns = clock.advance(image->stamp_ns);
      report.mark();
      odometry->addImage(*image, now_ns);
    }
    for (const EgoMotionResult& result : odometry->advance(now_ns)) outputs.write(result, bag_time, &report);
  }
  report.mark();
  for (const EgoMotionResult& result : odometry->finish()) outputs.write(result, bag_time, &report);
  outputs.close();
  if (!command.report.empty()) report.writeJson(command.report, odometry->counters(), parameters);
  std::printf("%s", report.summary().c_str());
  if (report.poses == 0) {
    std::fprintf(stderr, "egomotion_bag: no pose in %llu images and %llu IMU samples\n",
                 static_cast<unsigned long long>(report.images), static_cast<unsigned long long>(report.imu_samples));
    return 2;
  }
  return 0;
}

}  // namespace
}  // namespace multicam_egomotion

int main(int argc, char** argv) {
  try {
    ros::Time::init();
    multicam_egomotion::BagCommand command;
    if (!multicam_egomotion::parseCommandLine(argc, argv, &command)) return 0;
    return multicam_egomotion::run(command);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "egomotion_bag: %s\n", error.what());
    return 1;
  }
}
