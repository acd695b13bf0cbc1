// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

#include "multicam_egomotion/geometry/ray.h"
#include "multicam_egomotion/solvers/four_point_axis.h"
#include "multicam_egomotion/solvers/four_point_vertical.h"

namespace multicam_egomotion {

/// 4pt-vertical for estimate<Solver>(): the models of a sample that have all its points in front of their rays.
struct FourPointVertical {
  static constexpr int kSampleSize = 4;
  using Prior = VerticalPrior;
  static auto solve(const std::array<RayCorrespondence, 4>& sample, const Prior& prior) {
    return solveFourPointVertical(sample, prior, {true});
  }
};

/// 4pt-axis for estimate<Solver>(), likewise.
struct FourPointAxis {
  static constexpr int kSampleSize = 4;
  using Prior = AxisPrior;
  static auto solve(const std::array<RayCorrespondence, 4>& sample, const Prior& prior) {
    return solveFourPointAxis(sample, prior, {true});
  }
};

}  // namespace multicam_egomotion
