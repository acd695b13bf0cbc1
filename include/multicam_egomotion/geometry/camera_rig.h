// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <string>
#include <vector>

#include "multicam_egomotion/geometry/camera_model.h"

namespace multicam_egomotion {

/// How far a calibration may be off: standard deviations. Defaults as people calibrate; 0 is known exactly.
struct CameraSigmas {
  double rotation = 0.1 * M_PI / 180.0;  ///< of T_body_cam, per axis [rad]
  double position = 0.002;               ///< of T_body_cam, per axis [m]
  double focal_length = 0.002;           ///< share of it
  double principal_point_px = 0.5;       ///< per axis [px]
  double distortion_px = 0.3;            ///< displacement of a pixel at the image's corner [px]
  double time_offset_s = 0.002;          ///< [s]
};

struct RigCamera {
  std::string name;
  std::string frame_id;  ///< optical frame
  CameraModel model;
  Eigen::Isometry3d T_body_cam;  ///< camera pose in the body frame [m]
  double time_offset_s = 0.0;    ///< t_imu = t_image + time_offset_s
  CameraSigmas sigmas = {};
};

/// One to eight calibrated cameras rigidly mounted on the body. Immutable once built (contract 11).
class CameraRig {
 public:
  static constexpr int kMaxCameras = 8;

  /// Throws std::invalid_argument on 0 or more than 8 cameras, a T_body_cam that is not a rigid motion, a camera more
  /// than 100 m away from the body, or a time offset of more than 10 s.
  explicit CameraRig(std::vector<RigCamera> cameras);

  int size() const { return static_cast<int>(cameras_.size()); }
  const RigCamera& camera(int index) const { return cameras_[index]; }
  const std::vector<RigCamera>& cameras() const { return cameras_; }

  /// Share (0 to 1) of the image of camera `from` whose points between 2 and 50 m are seen by camera `to`.
  double overlap(int from, int to) const { return overlap_[from * size() + to]; }
  /// Cameras that overlap with `camera` by at least 5 %, most first.
  const std::vector<int>& overlappingCameras(int camera) const { return overlapping_[camera]; }
  /// Largest distance between two camera centres [m].
  double baseline() const { return baseline_; }

 private:
  std::vector<RigCamera> cameras_;
  std::vector<double> overlap_;
  std::vector<std::vector<int>> overlapping_;
  double baseline_ = 0.0;
};

}  // namespace multicam_egomotion
