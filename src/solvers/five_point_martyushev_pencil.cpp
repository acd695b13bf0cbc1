// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <limits>

#include "five_point_martyushev_axes.h"
#include "five_point_martyushev_tables.h"
#include "instruction_sets.h"

namespace multicam_egomotion {
namespace {

constexpr double kDependent = 1e-10;

namespace build_instructions {
#include "francis_eigenvalues.inc"
//
#include "five_point_martyushev_eigen.inc"
//
#include "five_point_martyushev_pencil.inc"
}  // namespace build_instructions

#if MULTICAM_EGOMOTION_DISPATCH_AVX2
#pragma GCC push_options
#pragma GCC target("avx2,fma")
namespace avx2_instructions {
#include "francis_eigenvalues.inc"
//
#include "five_point_martyushev_eigen.inc"
//
#include "five_point_martyushev_pencil.inc"
}  // namespace avx2_instructions
#pragma GCC pop_options
#endif

}  // namespace

bool pencilAxes(const AxisSystem& system, bool with_axes, ApproximateAxes& result) {
  const double* m = system.coefficients().data();
#if MULTICAM_EGOMOTION_DISPATCH_AVX2
  if (processorHasAvx2()) return avx2_instructions::pencilAxes(m, with_axes, result);
#endif
  return build_instructions::pencilAxes(m, with_axes, result);
}

}  // namespace multicam_egomotion
