// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <multicam_egomotion/Calibration.h>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "multicam_egomotion/odometry/ego_motion.h"
#include "multicam_egomotion/ros/messages.h"

namespace multicam_egomotion {

/// The estimates as a message, each with the name that its camera has in the rig.
Calibration toCalibrationMessage(const std::vector<CameraCalibration>& calibration, const CameraRig& rig,
                                 std::int64_t stamp_ns, const FrameNames& frames);

/// The messages of the topic `calibration`: one at the first call, then at most one a second of data time.
class CalibrationMessages {
 public:
  /// Empty when it is not yet time, or when the odometry estimates no calibration.
  std::optional<Calibration> next(const EgoMotion& odometry, std::int64_t stamp_ns, const FrameNames& frames);

 private:
  std::optional<std::int64_t> last_ns_;
};

/// For people, such as "-0.011 0.209 0.105 deg (sigma 0.001 0.002 0.001)".
std::string rotationText(const CameraCalibration& calibration);

}  // namespace multicam_egomotion
