// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "multicam_egomotion/geometry/camera_rig.h"
#include "multicam_egomotion/imu/imu_calibration.h"

namespace multicam_egomotion {

/// A rig as somebody may have calibrated it.
struct CalibratedRig {
  CameraRig rig;
  ImuCalibration imu;
};

/// The rig with normally distributed errors of `scale` times the standard deviations that it states itself: rotation
/// and position of each further camera, focal length (fx and fy alike), principal point of each further camera,
/// distortion, time offset and the rotation of the IMU's mounting. The cameras are triggered together, so that all have
/// the time offset error of camera 0. Camera 0 is where it is by definition, and an error of its principal point is one
/// of the IMU's mounting. Deterministic; scale 0 gives the rig itself.
/// Throws std::invalid_argument if scale is negative or not finite, or leaves no valid camera.
CalibratedRig miscalibrated(const CameraRig& rig, const ImuCalibration& imu, double scale, std::uint64_t seed);

/// Displacement of the outermost pixel that the model sees towards the corner farthest from the principal point,
/// when the first radial coefficient grows by one [px]. Positive: away from the principal point.
double cornerDisplacement(const CameraModel& model);

}  // namespace multicam_egomotion
