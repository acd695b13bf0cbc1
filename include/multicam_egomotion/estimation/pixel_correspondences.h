// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "multicam_egomotion/estimation/correspondence_set.h"
#include "multicam_egomotion/geometry/camera_rig.h"
#include "multicam_egomotion/geometry/ray.h"

namespace multicam_egomotion {

/// The same point in an image at t1 and in one at t2, of the same or of another camera. Pixels as in CameraModel.
struct PixelCorrespondence {
  int camera1 = 0;         ///< camera index at t1
  Eigen::Vector2d pixel1;  ///< [px]
  int camera2 = 0;         ///< camera index at t2
  Eigen::Vector2d pixel2;  ///< [px]
  double quality = 0.0;    ///< for PROSAC: the better, the higher; any unit
};

/// Rays, in body axes, of a pixel correspondence, and the image scales at both pixels; false where a pixel lies beyond
/// the field of view that its camera's calibration can invert, or is not finite.
/// Throws std::invalid_argument on a camera that the rig does not have.
bool entryFromPixels(const CameraRig& rig, const PixelCorrespondence& pixels, CorrespondenceSet::Entry* entry);

/// Correspondences for estimate<Solver>() and, by `set.rays(i)`, samples for the minimal solvers.
struct PixelCorrespondenceSet {
  CorrespondenceSet set;
  std::vector<int> indices;  ///< which of the pixel correspondences each one of the set is: all but those without a ray
};

/// All pixel correspondences of one frame pair, as entryFromPixels().
PixelCorrespondenceSet correspondencesFromPixels(const CameraRig& rig, const std::vector<PixelCorrespondence>& pixels);

}  // namespace multicam_egomotion
