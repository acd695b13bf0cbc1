// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
//
// What every solver asks of its input.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include "multicam_egomotion/geometry/ray.h"
#include "multicam_egomotion/solvers/relative_pose.h"

namespace multicam_egomotion {

inline bool samePair(const RayCorrespondence& a, const RayCorrespondence& b) {
  return a.camera1 == b.camera1 && a.camera2 == b.camera2;
}

inline bool isRotation(const Eigen::Matrix3d& R) {
  return std::abs(R.squaredNorm() - 3.0) < 1e-6 && std::abs(R.col(0).cross(R.col(1)).dot(R.col(2)) - 1.0) < 1e-6;
}

/// The cameras of the sample have centres, where centres are given.
template <std::size_t kSize>
bool centersCover(const std::array<RayCorrespondence, kSize>& sample, const SolverOptions& options) {
  if (options.camera_centers == nullptr) return true;
  for (const RayCorrespondence& ray : sample) {
    if (ray.camera1 < 0 || ray.camera1 >= options.camera_count || ray.camera2 < 0 ||
        ray.camera2 >= options.camera_count) {
      return false;
    }
  }
  return true;
}

}  // namespace multicam_egomotion
