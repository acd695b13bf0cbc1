// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "multicam_egomotion/geometry/camera_rig.h"

namespace multicam_egomotion {

/// Of images that are all taken at the reference stamp.
inline std::vector<Eigen::Isometry3d> cameraPosesOf(const CameraRig& rig) {
  std::vector<Eigen::Isometry3d> poses;
  for (const RigCamera& camera : rig.cameras()) poses.push_back(camera.T_body_cam);
  return poses;
}

}  // namespace multicam_egomotion
