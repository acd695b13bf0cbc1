// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <map>
#include <string>
#include <vector>

#include "multicam_egomotion/odometry/ego_motion.h"
#include "multicam_egomotion/ros/parameters.h"

namespace multicam_egomotion {

/// Times and counts of one run over a bag.
class RunReport {
 public:
  /// Called at the end of a stage of a frame: its time is that since the previous stage; "frame" is the whole frame.
  void stage(const char* name);
  /// The next stage begins now.
  void mark() { stage_begin_ = frame_begin_ = Clock::now(); }
  void addDecodeTime(double seconds) { times_ms_["decode"].push_back(1e3 * seconds); }
  void addResult(const EgoMotionResult& result);

  bool interrupted = false;  ///< before the end of the bag
  std::uint64_t images = 0, imu_samples = 0, undecodable_images = 0, poses = 0;
  std::vector<std::string> messages;  ///< what is wrong with the data at the end of the bag, as the odometry says

  /// With what `odometry` says at the end of the run. Throws std::runtime_error when the file cannot be written.
  void writeJson(const std::string& path, const EgoMotion& odometry, const Parameters& parameters) const;
  /// A few lines for a person.
  std::string summary(const EgoMotion& odometry) const;

 private:
  using Clock = std::chrono::steady_clock;

  Clock::time_point begin_ = Clock::now(), stage_begin_ = begin_, frame_begin_ = begin_;
  std::map<std::string, std::vector<double>> times_ms_;
  std::map<std::string, std::uint64_t> statuses_, scale_states_, solvers_;
  std::vector<double> tracks_, inliers_;
  std::uint64_t frames_ = 0, keyframes_ = 0, coast_ticks_ = 0;
  std::uint32_t odom_epoch_ = 0;
};

}  // namespace multicam_egomotion
