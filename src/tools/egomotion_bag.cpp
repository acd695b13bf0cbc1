// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
// Odometry of a recorded bag without a roscore: the class and the parameters of the nodelet, as fast as the machine
// can. SIGINT and SIGTERM end the run early with complete files. Exit code 1 on failure, 2 when there was no pose.
#include <tf2_msgs/TFMessage.h>

#include <algorithm>
#include <cstdio>
#include <optional>
#include <stdexcept>

#include "bag_runner/bag_replay.h"
#include "bag_runner/command_line.h"
#include "bag_runner/output_bag.h"
#include "bag_runner/rig_output.h"
#include "bag_runner/run_report.h"
#include "bag_runner/trajectory_files.h"
#include "multicam_egomotion/ros/calibration_message.h"
#include "multicam_egomotion/ros/ego_motion_message.h"
#include "stop_signals.h"

namespace multicam_egomotion {
namespace {

/// The files that were asked for, filled result by result.
struct Outputs {
  Outputs(const BagCommand& command, const Parameters& parameters, const EgoMotion& source, const BagReplay& replay)
      : odometry(source), frames{parameters.node.odom_frame, replay.topics().base_frame} {
    if (!command.write_rig.empty()) rig.emplace(command.write_rig, replay.rigFile(), parameters.node);
    if (!command.trajectory.empty()) tum.emplace(command.trajectory);
    if (!command.kitti.empty()) kitti.emplace(command.kitti, odometry.rig().camera(0).T_body_cam);
    if (!command.output_bag.empty()) bag.emplace(command.output_bag);
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
    if (bag) bag->write([&](rosbag::Bag& output) { writeMessages(result, time, &output); });
  }

  void writeMessages(const EgoMotionResult& result, const ros::Time& time, rosbag::Bag* output) {
    writeEgoMotion(output, "ego_motion", time, result, frames);
    if (const std::optional<Calibration> message = calibration.next(odometry, result.stamp_ns, frames)) {
      output->write("calibration", time, *message);
    }
    if (result.has_relative_pose) output->write("relative_pose", time, toRelativePose(result, frames));
    if (!result.has_pose) return;
    output->write("odometry", time, toOdometry(result, frames));
    tf2_msgs::TFMessage transforms;
    transforms.transforms.push_back(toTransform(result, frames));
    output->write("/tf", time, transforms);
  }

  void close() {
    if (tum) tum->close();
    if (kitti) kitti->close();
    if (bag) bag->close();
    if (rig) rig->write(odometry);
  }

  const EgoMotion& odometry;
  FrameNames frames;
  CalibrationMessages calibration;
  std::optional<RigOutput> rig;
  std::optional<TumFile> tum;
  std::optional<KittiFile> kitti;
  std::optional<OutputBag> bag;
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

int run(const BagCommand& command) {
  const Parameters parameters = readParameters(command);
  const rosbag::Bag bag(command.bag, rosbag::bagmode::Read);
  BagReplay replay(bag, parameters, command.imu_topic);
  EgoMotion& odometry = replay.odometry();
  Outputs outputs(command, parameters, odometry, replay);
  RunReport report;
  replay.play([&](const EgoMotionResult& result, const ros::Time& time) { outputs.write(result, time, &report); },
              &report,
              [&outputs](int camera, std::int64_t stamp_ns) {
                if (outputs.kitti && camera == 0) outputs.kitti->addImage(stamp_ns);
              },
              &StopSignals::received);
  outputs.close();
  if (!command.report.empty()) report.writeJson(command.report, odometry, parameters);
  std::printf("%s", report.summary(odometry).c_str());
  if (report.interrupted) {
    std::fprintf(stderr, "egomotion_bag: interrupted; the files hold what came before\n");
    return 0;
  }
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
    multicam_egomotion::StopSignals::watch();
    ros::Time::init();
    multicam_egomotion::BagCommand command;
    if (!multicam_egomotion::parseCommandLine(argc, argv, &command)) return 0;
    return multicam_egomotion::run(command);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "egomotion_bag: %s\n", error.what());
    return 1;
  }
}
