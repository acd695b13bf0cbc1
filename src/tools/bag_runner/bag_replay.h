// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <rosbag/bag.h>

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "bag_runner/run_report.h"
#include "multicam_egomotion/odometry/rig_file.h"
#include "multicam_egomotion/ros/rig_setup.h"

namespace multicam_egomotion {

/// A bag through the odometry as fast as the machine can: the class and the parameters of the nodelet, inputs in the
/// order of the recording.
class BagReplay {
 public:
  /// Each throws std::invalid_argument on what is wrong with the parameters, the rig or the bag's topics. The rig is
  /// that of the parameters' rig file, else of the bag's CameraInfo and TF. `imu_topic`: instead of the rig's.
  BagReplay(const rosbag::Bag& bag, const Parameters& parameters, const std::string& imu_topic = "");

  using OnResult = std::function<void(const EgoMotionResult& result, const ros::Time& bag_time)>;
  using OnImage = std::function<void(int camera, std::int64_t stamp_ns)>;

  /// Plays the bag to its end, or until `stop` (may be empty) says so: the report then says that it was interrupted.
  /// `on_image` (may be empty) sees every image that could be decoded, before its results.
  void play(const OnResult& on_result, RunReport* report, const OnImage& on_image = nullptr,
            const std::function<bool()>& stop = nullptr);

  const RigTopics& topics() const { return topics_; }
  /// The rig before the run, as a file that a run can read: the rig file as it is, or the bag's CameraInfo and TF.
  const RigFile& rigFile() const { return *rig_file_; }
  EgoMotion& odometry() { return *odometry_; }

 private:
  const rosbag::Bag& bag_;
  bool use_imu_;
  RigTopics topics_;
  std::optional<RigFile> rig_file_;
  std::unique_ptr<EgoMotion> odometry_;
};

}  // namespace multicam_egomotion
