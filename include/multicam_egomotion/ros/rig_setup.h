// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "multicam_egomotion/geometry/camera_rig.h"
#include "multicam_egomotion/imu/imu_calibration.h"
#include "multicam_egomotion/odometry/ego_motion.h"
#include "multicam_egomotion/ros/parameters.h"

namespace multicam_egomotion {

/// A complete rig: all that the odometry needs before the first image.
struct RigSetup {
  CameraRig rig;
  ImuCalibration imu;
};

/// Where the inputs come from and what the body is called.
struct RigTopics {
  std::vector<std::string> images;        ///< one a camera
  std::vector<std::string> camera_infos;  ///< one a camera
  std::string imu;
  std::string base_frame;
};

/// Topics of the parameters alone: cam<i>/image_raw, cam<i>/camera_info, imu.
RigTopics defaultTopics(int cameras, const std::string& base_frame);

/// Reads node.rig_file into `setup` and its topics, where it names any, into `topics`. Throws std::invalid_argument on
/// a file that is wrong, or that has no IMU when odometry.use_imu wants one.
RigSetup loadRigSetup(const Parameters& parameters, RigTopics* topics);

/// The odometry with the masks of node.mask_files; throws std::invalid_argument.
std::unique_ptr<EgoMotion> makeEgoMotion(const RigSetup& setup, const Parameters& parameters);

}  // namespace multicam_egomotion
