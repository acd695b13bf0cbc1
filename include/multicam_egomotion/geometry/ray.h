// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

namespace multicam_egomotion {

/// Plücker line of an observed point in the body frame (paper, section III-A).
struct Ray {
  Eigen::Vector3d direction;  ///< x = Q u / |Q u|, unit, from the camera towards the point
  Eigen::Vector3d moment;     ///< q = s × x, s the camera centre in the body frame [m]
};

/// The same point seen from the body at t1 and at t2, with the cameras that saw it.
struct RayCorrespondence {
  Ray first;        ///< in the body frame at t1
  Ray second;       ///< in the body frame at t2
  int camera1 = 0;  ///< camera index at t1
  int camera2 = 0;  ///< camera index at t2; different from camera1 for a cross-camera correspondence
};

/// Ray through the point seen along `bearing` (unit, camera frame rotated into the body) from `center` [m].
inline Ray makeRay(const Eigen::Vector3d& direction, const Eigen::Vector3d& center) {
  return {direction, center.cross(direction)};
}

}  // namespace multicam_egomotion
