// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "multicam_egomotion/ros/diagnostics.h"

#include <algorithm>

#include "multicam_egomotion/ros/calibration_message.h"

namespace multicam_egomotion {
namespace {

using diagnostic_msgs::DiagnosticStatus;

std::string joined(const std::vector<std::string>& texts) {
  std::string all;
  for (const std::string& text : texts) all += (all.empty() ? "" : ", ") + text;
  return all;
}

void summarize(const Health& health, diagnostic_updater::DiagnosticStatusWrapper& status) {
  if (health.state == Health::State::kConfigError) {
    status.summary(DiagnosticStatus::ERROR, "CONFIG_ERROR: " + health.message);
    return;
  }
  if (health.paused) {
    status.summary(DiagnosticStatus::WARN, "PAUSED");
  } else if (health.state == Health::State::kWaiting) {
    status.summary(DiagnosticStatus::WARN, "waiting for " + health.message);
  } else if (!health.result) {
    status.summary(DiagnosticStatus::WARN, "waiting for data");
  } else {
    const EgoMotionStatus odometry = health.result->status;
    const auto level = odometry == EgoMotionStatus::kTracking ? DiagnosticStatus::OK
                       : odometry == EgoMotionStatus::kLost   ? DiagnosticStatus::ERROR
                                                              : DiagnosticStatus::WARN;
    status.summary(level, name(odometry));
    if (health.rate_hz == 0.0) status.mergeSummary(DiagnosticStatus::ERROR, "no new frame");
  }
  if (!health.silent_topics.empty()) {
    status.mergeSummary(DiagnosticStatus::WARN, "no data on " + joined(health.silent_topics));
  }
  for (const std::string& fault : health.faults) status.mergeSummary(DiagnosticStatus::WARN, fault);
  if (health.changed_camera_infos > 0) {
    status.mergeSummary(DiagnosticStatus::WARN, "CameraInfo changed after the start and is ignored");
  }
}

void describeCalibration(const Health& health, diagnostic_updater::DiagnosticStatusWrapper& status) {
  for (const CameraCalibration& one : health.calibration) {
    const std::string& camera = health.cameras.at(one.camera);
    status.add(camera + " rotation", rotationText(one));
    if (!one.overlaps) continue;
    status.addf(camera + " focal length [%]", "%.3f", 100.0 * one.focal_length);
    status.addf(camera + " static error [px]", "%.2f", one.static_error_px);
  }
}

}  // namespace

void describe(const Health& health, diagnostic_updater::DiagnosticStatusWrapper& status) {
  summarize(health, status);
  status.addf("rate [Hz]", "%.1f", health.rate_hz);
  status.addf("latency median [ms]", "%.1f", health.median_latency_ms);
  status.addf("latency worst [ms]", "%.1f", health.worst_latency_ms);
  if (health.result) {
    const EgoMotionResult& result = *health.result;
    status.add("status", name(result.status));
    status.add("tracks", result.tracks);
    status.add("inliers", result.inliers);
    status.addf("inlier ratio", "%.2f", result.tracks > 0 ? static_cast<double>(result.inliers) / result.tracks : 0.0);
    status.add("solver", result.solver);
    status.add("scale state", name(result.scale_state));
    status.addf("scale sigma", "%.3f", result.scale_sigma);
    status.add("IMU state", !health.use_imu                                   ? "not used"
                            : result.status == EgoMotionStatus::kInitializing ? "initializing"
                                                                              : "running");
    if (health.use_imu) status.add("gyroscope", health.gyroscope_check);
    status.addf("tilt sigma [rad]", "%.4f", result.tilt_sigma);
    status.addf("gyroscope bias [rad/s]", "%.5f %.5f %.5f", result.gyroscope_bias.x(), result.gyroscope_bias.y(),
                result.gyroscope_bias.z());
    status.addf("accelerometer bias [m/s^2]", "%.4f %.4f %.4f", result.accelerometer_bias.x(),
                result.accelerometer_bias.y(), result.accelerometer_bias.z());
    status.add("odom epoch", result.odom_epoch);
  }
  describeCalibration(health, status);
  status.add("frame sets", health.counters.frame_sets);
  status.add("frame sets without IMU", health.counters.frame_sets_without_imu);
  status.add("estimation failures", health.counters.estimation_failures);
  status.add("time jumps", health.counters.time_jumps);
  status.add("rejected IMU samples", health.counters.rejected_imu);
  status.add("late images", health.counters.late_images);
  status.add("rejected images", health.counters.rejected_images);
  status.add("dropped images", health.dropped_images);
  status.add("dropped IMU samples", health.dropped_imu);
  status.add("undecodable images", health.undecodable_images);
  status.add("changed CameraInfo", health.changed_camera_infos);
  status.add("internal errors", health.internal_errors);
}

Diagnostics::Diagnostics(ros::NodeHandle node, ros::NodeHandle private_node)
    : updater_(node, private_node, private_node.getNamespace()) {
  updater_.setHardwareID("none");
  updater_.add("odometry", [this](diagnostic_updater::DiagnosticStatusWrapper& status) { describe(health_, status); });
}

void Diagnostics::noteResult(const EgoMotionResult& result, std::optional<double> latency_ms) {
  EgoMotionResult& kept = health_.result ? *health_.result : health_.result.emplace();
  kept = result;
  kept.features.clear();
  kept.points.clear();
  ++results_;
  if (latency_ms) latencies_ms_.push_back(*latency_ms);
}

bool Diagnostics::due() const { return Clock::now() - published_ >= std::chrono::seconds(1); }

void Diagnostics::publish() {
  const Clock::time_point now = Clock::now();
  health_.rate_hz = results_ / std::chrono::duration<double>(now - published_).count();
  health_.median_latency_ms = health_.worst_latency_ms = 0.0;
  if (!latencies_ms_.empty()) {
    std::sort(latencies_ms_.begin(), latencies_ms_.end());
    health_.median_latency_ms = latencies_ms_[latencies_ms_.size() / 2];
    health_.worst_latency_ms = latencies_ms_.back();
  }
  published_ = now;
  results_ = 0;
  latencies_ms_.clear();
  updater_.force_update();
}

}  // namespace multicam_egomotion
