// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sensor_msgs/CameraInfo.h>
#include <tf2/buffer_core.h>

#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <vector>

#include "multicam_egomotion/geometry/camera_rig.h"

namespace multicam_egomotion {

/// Pose of `frame` in `base_frame`, or nothing while TF does not connect them.
std::optional<Eigen::Isometry3d> mountingFromTf(const tf2::BufferCore& tf, const std::string& base_frame,
                                                const std::string& frame);

/// Intrinsics as the images on the topic have them: binning and region of interest applied; K and D, or P for rectified
/// images. Throws std::invalid_argument (frame, found, expected) on an uncalibrated camera or an unknown model.
CameraModel cameraModelFromInfo(const sensor_msgs::CameraInfo& info, bool rectified);

/// Both describe the same images: a rig is frozen once built.
bool sameCalibration(const sensor_msgs::CameraInfo& a, const sensor_msgs::CameraInfo& b);

/// Rig of one CameraInfo a camera, named cam0, cam1, ... (contract 11). A frame_id of its own is the optical frame of
/// the camera, placed by TF; cameras that share a frame_id are placed in it by their baseline, -P[3]/P[0]. A rectified
/// camera is turned by its R. Nothing while TF does not know a frame. `warnings` receives baselines of P that TF
/// contradicts. Throws std::invalid_argument when cameras share a frame_id and no P tells them apart.
std::optional<CameraRig> rigFromCameraInfo(const std::vector<sensor_msgs::CameraInfo>& infos, bool rectified,
                                           double time_offset_s, const tf2::BufferCore& tf,
                                           const std::string& base_frame, std::vector<std::string>* warnings);

}  // namespace multicam_egomotion
