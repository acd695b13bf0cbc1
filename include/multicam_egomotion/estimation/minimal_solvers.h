// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

#include "multicam_egomotion/geometry/ray.h"
#include "multicam_egomotion/solvers/five_point_martyushev.h"
#include "multicam_egomotion/solvers/four_point_axis.h"
#include "multicam_egomotion/solvers/four_point_lee.h"
#include "multicam_egomotion/solvers/four_point_liu.h"
#include "multicam_egomotion/solvers/four_point_sweeney.h"
#include "multicam_egomotion/solvers/four_point_vertical.h"

namespace multicam_egomotion {

// The six minimal solvers for estimate<Solver>().

/// 4pt-vertical
struct FourPointVertical {
  static constexpr int kSampleSize = 4;
  using Prior = VerticalPrior;
  static auto solve(const std::array<RayCorrespondence, 4>& sample, const Prior& prior, const SolverOptions& options) {
    return solveFourPointVertical(sample, prior, options);
  }
};

/// 4pt-axis
struct FourPointAxis {
  static constexpr int kSampleSize = 4;
  using Prior = AxisPrior;
  static auto solve(const std::array<RayCorrespondence, 4>& sample, const Prior& prior, const SolverOptions& options) {
    return solveFourPointAxis(sample, prior, options);
  }
};

/// 4pt-lee
struct FourPointLee {
  static constexpr int kSampleSize = 4;
  using Prior = VerticalPrior;
  static auto solve(const std::array<RayCorrespondence, 4>& sample, const Prior& prior, const SolverOptions& options) {
    return solveFourPointLee(sample, prior, options);
  }
};

/// 4pt-liu
struct FourPointLiu {
  static constexpr int kSampleSize = 4;
  using Prior = VerticalPrior;
  static auto solve(const std::array<RayCorrespondence, 4>& sample, const Prior& prior, const SolverOptions& options) {
    return solveFourPointLiu(sample, prior, options);
  }
};

/// 4pt-sweeney
struct FourPointSweeney {
  static constexpr int kSampleSize = 4;
  using Prior = AxisPrior;
  static auto solve(const std::array<RayCorrespondence, 4>& sample, const Prior& prior, const SolverOptions& options) {
    return solveFourPointSweeney(sample, prior, options);
  }
};

/// 5pt-martyushev
struct FivePointMartyushev {
  static constexpr int kSampleSize = 5;
  using Prior = AnglePrior;
  static auto solve(const std::array<RayCorrespondence, 5>& sample, const Prior& prior, const SolverOptions& options) {
    return solveFivePointMartyushev(sample, prior, options);
  }
};

}  // namespace multicam_egomotion
