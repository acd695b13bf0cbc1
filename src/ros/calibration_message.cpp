// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "multicam_egomotion/ros/calibration_message.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace multicam_egomotion {
namespace {

constexpr std::int64_t kCalibrationPeriodNs = 1000000000;

}  // namespace

Calibration toCalibrationMessage(const std::vector<CameraCalibration>& calibration, const CameraRig& rig,
                                 std::int64_t stamp_ns, const FrameNames& frames) {
  Calibration message;
  message.header.stamp = toRosTime(stamp_ns);
  message.header.frame_id = frames.base;
  for (const CameraCalibration& one : calibration) {
    CalibratedCamera camera;
    camera.name = rig.camera(one.camera).name;
    camera.rotation = toRosVector(one.rotation);
    std::copy_n(one.covariance.data(), 9, camera.rotation_covariance.begin());  // symmetric: rows are columns
    camera.overlaps = one.overlaps;
    camera.focal_length = one.focal_length;
    camera.static_error_px = one.static_error_px;
    message.cameras.push_back(camera);
  }
  return message;
}

std::optional<Calibration> CalibrationMessages::next(const EgoMotion& odometry, std::int64_t stamp_ns,
                                                     const FrameNames& frames) {
  // Stamps that jump back begin anew.
  if (last_ns_ && stamp_ns >= *last_ns_ && stamp_ns - *last_ns_ < kCalibrationPeriodNs) return std::nullopt;
  last_ns_ = stamp_ns;
  const std::vector<CameraCalibration> calibration = odometry.calibration();
  if (calibration.empty()) return std::nullopt;
  return toCalibrationMessage(calibration, odometry.rig(), stamp_ns, frames);
}

std::string rotationText(const CameraCalibration& calibration) {
  constexpr double kDegrees = 180.0 / M_PI;
  const Eigen::Vector3d rotation = kDegrees * calibration.rotation;
  const Eigen::Vector3d sigma = kDegrees * calibration.covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
  char text[128];
  std::snprintf(text, sizeof(text), "%.3f %.3f %.3f deg (sigma %.3f %.3f %.3f)", rotation.x(), rotation.y(),
                rotation.z(), sigma.x(), sigma.y(), sigma.z());
  return text;
}

}  // namespace multicam_egomotion
