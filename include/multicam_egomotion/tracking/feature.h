// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <memory>

#include "multicam_egomotion/geometry/camera_rig.h"
#include "multicam_egomotion/tracking/image_point.h"
#include "multicam_egomotion/tracking/patch_alignment.h"
#include "multicam_egomotion/tracking/tracked_frame.h"

namespace multicam_egomotion {

/// Patch of a feature in the frame that all later ones are aligned to.
struct ReferencePatch {
  PatchTemplate patch;
  Eigen::Matrix2d linear = Eigen::Matrix2d::Identity();  ///< from the reference patch to the newest image
  Eigen::Matrix<double, 2, 3> curvature = Eigen::Matrix<double, 2, 3>::Zero();  ///< of the image where it was cut
  int failures = 0;  ///< frames in a row in which the alignment failed
};

/// One feature of the tracker in its newest frame.
struct Feature {
  TrackId id = 0;
  int owner = 0;  ///< camera in which it is tracked in time
  bool alive = true;
  double inverse_distance = -1.0;  ///< in the owner, along its bearing [1/m]; negative: unknown
  std::array<bool, CameraRig::kMaxCameras> seen{};
  std::array<ImagePoint, CameraRig::kMaxCameras> points;  ///< where seen
  std::unique_ptr<ReferencePatch> reference;              ///< in the owner
};

}  // namespace multicam_egomotion
