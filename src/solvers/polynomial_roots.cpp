// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "multicam_egomotion/solvers/polynomial_roots.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

#include "instruction_sets.h"

#pragma GCC diagnostic ignored "-Wpsabi"

namespace multicam_egomotion {

namespace build_instructions {
namespace {
#include "lanes.inc"
//
#include "real_roots.inc"
}  // namespace
}  // namespace build_instructions

#if MULTICAM_EGOMOTION_DISPATCH_AVX2
#pragma GCC push_options
#pragma GCC target("avx2,fma")
namespace avx2_instructions {
namespace {
#include "lanes.inc"
//
#include "real_roots.inc"
}  // namespace
}  // namespace avx2_instructions
#pragma GCC pop_options
#endif

namespace {

constexpr double kLastStep = 1e-6;

template <typename LaneRoots>
RealRoots toRealRoots(const LaneRoots& lanes) {
  RealRoots roots;
  roots.count = lanes.count;
  for (int i = 0; i < lanes.count; ++i) {
    roots.x[i] = lanes.x[i];
    roots.reciprocal[i] = lanes.reciprocal[i] > 0.5;
  }
  return roots;
}

}  // namespace

RealRoots findRealRoots(const std::array<double, 7>& coefficients, int degree) {
  double largest = 0, a[7] = {};
  if (degree < 1 || degree > 6) return {};
  for (int k = 0; k <= degree; ++k) {
    if (!std::isfinite(coefficients[k])) return {};
    largest = std::max(largest, std::abs(coefficients[k]));
  }
  if (largest == 0) return {};
  // Near 1 no product of two values over- or underflows.
  int exponent;
  std::frexp(largest, &exponent);
  for (int k = 0; k <= degree; ++k) a[k] = std::ldexp(coefficients[k], -exponent);

#if MULTICAM_EGOMOTION_DISPATCH_AVX2
  if (processorHasAvx2()) {
    avx2_instructions::LaneRoots roots;
    avx2_instructions::findRoots(a, degree, 0.0, kLastStep, roots);
    return toRealRoots(roots);
  }
#endif
  build_instructions::LaneRoots roots;
  build_instructions::findRoots(a, degree, 0.0, kLastStep, roots);
  return toRealRoots(roots);
}

}  // namespace multicam_egomotion
