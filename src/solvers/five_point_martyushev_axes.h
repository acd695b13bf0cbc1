// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>

#include "five_point_martyushev_system.h"

namespace multicam_egomotion {

/// Starts for AxisSystem::refine.
struct ApproximateAxes {
  static constexpr int kCapacity = 64;
  std::array<Eigen::Vector3d, kCapacity> axes;
  int count = 0;

  void add(const Eigen::Vector3d& axis) {
    if (count < kCapacity) axes[count++] = axis;
  }
};

/// All real axes at which M has rank 3, and the real parts of pairs close to real. Functions of degree ≤ 8 on the
/// sphere modulo the minors of M have 44 dimensions; multiplication by z there has the heights of the solutions as
/// eigenvalues, taken in projective form because solutions may be at infinity. Loses accuracy at small angles, where
/// most of the 44 move to infinity. Returns false where the minors are dependent: M has rank 3 on a curve or
/// everywhere.
bool pencilAxes(const AxisSystem& system, bool with_axes, ApproximateAxes& result);

/// Axes in the limit of small angles. M(I) has rank 2 where the motion is a translation only, so a third and a fourth
/// singular value of the order of the angle; the other two stand apart. Eliminating these leaves a 3x2 block that has
/// rank 1 where M has rank 3 and that is affine in n but for terms of the order of the angle over the singular value:
/// block(n) [1 s]ᵀ = 0 gives n(s) as a quotient of cubics, |n| = 1 six values of s. A second time about each axis
/// found.
void smallAngleAxes(const AxisSystem& system, ApproximateAxes& result);

}  // namespace multicam_egomotion
