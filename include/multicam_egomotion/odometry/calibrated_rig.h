// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "multicam_egomotion/geometry/camera_rig.h"
#include "multicam_egomotion/odometry/ego_motion_result.h"

namespace multicam_egomotion {

/// The rig with the estimated rotations in T_body_cam of the cameras that `calibration` names. Their rotation sigma
/// becomes the largest of the estimate in any direction, but at least 0.005 deg: errors of the images that do not
/// average out are not part of its covariance. Positions and focal lengths stay as they are.
CameraRig calibratedRig(const CameraRig& rig, const std::vector<CameraCalibration>& calibration);

/// One line for each camera that is beyond four sigmas of the rig file: its rotation, its focal length against that of
/// the camera it overlaps with, or what is left of its lens.
std::vector<std::string> calibrationFaults(const CameraRig& rig, const std::vector<CameraCalibration>& calibration);

}  // namespace multicam_egomotion
