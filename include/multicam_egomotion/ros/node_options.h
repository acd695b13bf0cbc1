// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace multicam_egomotion {

/// What the ROS layer itself can be told; the odometry's own options are EgoMotionOptions.
struct NodeOptions {
  std::string rig_file;               ///< rig YAML, or Kalibr's camchain-imucam.yaml; empty: rig from CameraInfo and TF
  std::string rig_imu_file;           ///< Kalibr's imu.yaml, beside a camchain-imucam.yaml
  int cameras = 2;                    ///< number of cameras cam0, cam1, ... without a rig file
  bool images_rectified = false;      ///< without a rig file: use P of CameraInfo, not K and D
  double camera_time_offset_s = 0.0;  ///< without a rig file: t_imu = t_image + camera_time_offset_s, all cameras
  std::string image_transport = "raw";  ///< raw, compressed (no plugin needed), or any image_transport plugin
  std::vector<std::string> mask_files;  ///< an image a camera, black = ignore; "" for none

  std::string odom_frame = "odom";
  std::string base_frame;            ///< the body; empty: body_frame of the rig file, base_link without one
  bool publish_tf = true;            ///< odom_frame -> base_frame
  bool publish_previous_tf = false;  ///< base_frame -> <base_frame>_previous, the frame of relative_pose
  bool publish_features = true;      ///< picture of the features, while someone subscribes
  bool publish_points = true;        ///< landmarks, while someone subscribes
  double path_period_s = 0.1;        ///< at least this long between two poses of the path [s]
  int path_length = 5000;            ///< most poses in the path; the oldest leave first
  bool start_paused = false;         ///< wait for ~resume
  bool forget_biases = false;        ///< ~reset also forgets the IMU's biases
};

}  // namespace multicam_egomotion
