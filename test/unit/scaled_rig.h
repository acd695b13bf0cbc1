// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "multicam_egomotion/geometry/camera_rig.h"

namespace multicam_egomotion {

/// The rig with images of `scale` times the size in each direction, the same fields of view.
inline CameraRig scaledRig(const CameraRig& rig, double scale) {
  std::vector<RigCamera> cameras = rig.cameras();
  for (RigCamera& camera : cameras) {
    const CameraModel& model = camera.model;
    camera.model = CameraModel(static_cast<int>(scale * model.width()), static_cast<int>(scale * model.height()),
                               scale * model.fx(), scale * model.fy(), scale * (model.cx() + 0.5) - 0.5,
                               scale * (model.cy() + 0.5) - 0.5, model.distortion(), model.coefficients());
  }
  return CameraRig(cameras);
}

}  // namespace multicam_egomotion
