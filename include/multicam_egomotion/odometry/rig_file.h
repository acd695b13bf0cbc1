// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "multicam_egomotion/geometry/camera_rig.h"
#include "multicam_egomotion/imu/imu_calibration.h"

namespace multicam_egomotion {

/// A calibrated rig as a file describes it. Topics are parallel to rig.cameras(), empty where the file names none.
struct RigFile {
  CameraRig rig;
  std::vector<std::string> image_topics;
  std::vector<std::string> camera_info_topics;
  std::string body_frame = "base_link";
  bool has_imu = false;
  ImuCalibration imu;  ///< meaningful if has_imu
};

/// Loads a rig from YAML: our own format (see writeRigFile, config/) or Kalibr's camchain-imucam.yaml as it is.
/// For Kalibr: the body is the IMU frame, `kalibr_imu_path` its imu.yaml (empty: default noise densities;
/// our own format takes none); cameras
/// pinhole with radtan, equidistant or none; timeshift_cam_imu is t_imu - t_cam; sigmas are the defaults.
/// Throws std::runtime_error naming file, key, what was found and what was expected.
RigFile loadRigFile(const std::string& path, const std::string& kalibr_imu_path = "");

/// Writes our own format; loadRigFile returns the same numbers, sigmas in degrees and percent to 15 digits. Throws
/// std::runtime_error if the file cannot be written.
void writeRigFile(const std::string& path, const RigFile& file);

}  // namespace multicam_egomotion
