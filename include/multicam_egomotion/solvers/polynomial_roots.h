// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

namespace multicam_egomotion {

/// Real roots of p(s) = Σ coefficients[k] s^k as points of the projective line: s = x, or s = 1 / x where `reciprocal`.
/// |x| ≤ 1, so roots near and at infinity are as exact as those near zero. A root that is double to rounding appears
/// once or twice (at s = ±1 exactly it may be missed). Order is not by size.
struct RealRoots {
  std::array<double, 6> x;
  std::array<bool, 6> reciprocal;
  int count = 0;
};

/// All real roots of a polynomial of nominal degree 1 to 6. A zero leading coefficient is a root at infinity
/// ({x = 0, reciprocal}). The zero polynomial and coefficients that are not finite have no roots.
/// Isolation: signs of the polynomial and of the Bernstein coefficients of its cubic Hermite interpolant on a fixed
/// grid of cells in s and 1 / s; cells with several sign changes are searched for extrema. Refinement: Halley steps
/// kept inside the bracket, in parallel over the roots.
RealRoots findRealRoots(const std::array<double, 7>& coefficients, int degree = 6);

}  // namespace multicam_egomotion
