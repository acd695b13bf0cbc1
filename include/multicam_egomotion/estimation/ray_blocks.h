// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

namespace multicam_egomotion {

/// Correspondences side by side, as many as fill a vector register of 32 bytes: bearings in body axes at t1 and t2 and
/// inverse squared image scales [rad^2/px^2] and weights. Zeros where there is no correspondence; they count nothing.
template <class T>
struct alignas(32) RayBlock {
  static constexpr int kSize = 32 / sizeof(T);
  T x1[kSize], y1[kSize], z1[kSize], x2[kSize], y2[kSize], z2[kSize], k1[kSize], k2[kSize], weight[kSize];
};

/// Blocks of one camera pair.
struct RaySegment {
  Eigen::Vector3d center1, center2;  ///< camera centres in the body at t1 and t2 [m]
  int begin, probe, end;             ///< blocks; those before `probe` are a random part
  int size;                          ///< correspondences, all at the front
};

/// All correspondences of a frame pair.
template <class T>
struct RayBlocks {
  std::vector<RayBlock<T>> blocks;
  std::vector<RaySegment> segments;
};

}  // namespace multicam_egomotion
