// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "multicam_egomotion/geometry/camera_rig.h"
#include "multicam_egomotion/imu/imu_calibration.h"

namespace multicam_egomotion {

struct RigDescription {
  std::vector<RigCamera> cameras;
  ImuCalibration imu;
};

RigDescription handheldRig();  ///< stereo, radtan, 12 cm; body, cameras and IMU all turned against each other
RigDescription stereoRig();    ///< stereo, radtan, 12 cm; body x forward
RigDescription carRig();       ///< front, left, rear, right, 95 deg each: they hardly overlap
RigDescription droneRig();     ///< two fisheyes of 165 deg, forward and down, 25 cm apart

}  // namespace multicam_egomotion
