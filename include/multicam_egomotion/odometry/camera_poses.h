// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "multicam_egomotion/geometry/camera_rig.h"
#include "multicam_egomotion/odometry/ego_motion_result.h"
#include "multicam_egomotion/tracking/frame_set.h"

namespace multicam_egomotion {

/// Pose of each camera in the body at the reference stamp (IMU clock), those that took their image earlier or later
/// carried there with the body's twist (contract 2).
std::vector<Eigen::Isometry3d> cameraPoses(const CameraRig& rig, const FrameSet& set, std::int64_t reference_ns,
                                           const TwistWithCovariance& twist);

}  // namespace multicam_egomotion
