// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

#include "multicam_egomotion/estimation/robust_estimator.h"
#include "multicam_egomotion/imu/inertial_state.h"
#include "multicam_egomotion/odometry/frame_assembler.h"
#include "multicam_egomotion/odometry/window.h"
#include "multicam_egomotion/tracking/feature_tracker.h"

namespace multicam_egomotion {

/// Everything that can be set, with its default. The ROS layer and the bag runner read these names from parameters.
struct EgoMotionOptions {
  bool use_imu = true;                     ///< false: vision alone (contract 9)
  bool calibrate_online = true;            ///< estimate rotations of the cameras and static errors of their images
  std::string imu_orientation = "filter";  ///< filter: own gravity; message: tilt from sensor_msgs/Imu orientation
  std::string solver = "auto";             ///< auto, 4pt-vertical, 4pt-axis (contract 8)
  std::uint64_t seed = 1;                  ///< of RANSAC

  double max_imu_wait_s = 0.2;                ///< how long a frame set waits for IMU data that reach its stamp
  double max_coast_s = 5.0;                   ///< without vision; then LOST
  double max_tilt_correction_rate = 0.00873;  ///< gravity corrections turn odom's attitude by at most this [rad/s]
  double constant_rate_sigma = 0.0524;        ///< rotation prior without IMU [rad]
  double initial_velocity_sigma = 5.0;        ///< per axis, when nothing is known of the speed [m/s]
  std::string on_time_jump = "reset";         ///< reset, continue (contract 13)

  FrameAssemblerOptions assembler;
  FeatureTrackerOptions tracker;
  InertialStateOptions inertial;
  RobustEstimatorOptions ransac;
  WindowOptions window;
};

/// Throws std::invalid_argument (name, found, expected) on options that cannot be; those of the parts are checked by
/// them.
void validate(const EgoMotionOptions& options);

}  // namespace multicam_egomotion
