// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <diagnostic_updater/diagnostic_updater.h>

#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "multicam_egomotion/odometry/ego_motion.h"

namespace multicam_egomotion {

/// Everything that /diagnostics says, at one moment.
struct Health {
  enum class State { kWaiting, kRunning, kConfigError };
  State state = State::kWaiting;
  std::string message;                         ///< what is waited for, or what is wrong
  std::vector<std::string> silent_topics;      ///< inputs without a message for two seconds
  std::vector<std::string> faults;             ///< of the data, as the odometry names them
  std::string gyroscope_check;                 ///< whether it agrees with the images
  std::vector<CameraCalibration> calibration;  ///< of each camera that is calibrated while running
  std::vector<std::string> cameras;            ///< names of all cameras of the rig
  std::optional<EgoMotionResult> result;       ///< the newest, without features and points
  bool use_imu = true;
  bool paused = false;
  EgoMotionCounters counters;
  std::uint64_t dropped_images = 0;  ///< the worker was too slow
  std::uint64_t dropped_imu = 0;
  std::uint64_t undecodable_images = 0;    ///< unknown encoding, broken compression
  std::uint64_t changed_camera_infos = 0;  ///< the rig is frozen at start
  std::uint64_t internal_errors = 0;       ///< exceptions out of the odometry
  double rate_hz = 0.0;                    ///< results since the previous report
  double median_latency_ms = 0.0;          ///< last image of a set received -> odometry published (contract 14)
  double worst_latency_ms = 0.0;
};

/// One status with its values; level and summary say what matters most.
void describe(const Health& health, diagnostic_updater::DiagnosticStatusWrapper& status);

/// Collects and publishes Health once a second of wall time. Used by one thread.
class Diagnostics {
 public:
  Diagnostics(ros::NodeHandle node, ros::NodeHandle private_node);

  Health& health() { return health_; }
  void noteResult(const EgoMotionResult& result, std::optional<double> latency_ms);
  /// True once a second: the caller then completes health() and calls publish().
  bool due() const;
  void publish();

 private:
  using Clock = std::chrono::steady_clock;

  Health health_;
  diagnostic_updater::Updater updater_;
  Clock::time_point published_ = Clock::now();
  int results_ = 0;
  std::vector<double> latencies_ms_;
};

}  // namespace multicam_egomotion
