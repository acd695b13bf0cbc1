// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

namespace multicam_egomotion {

/// A real root of a polynomial on the projective line: s = x, or s = 1 / x where `reciprocal`; |x| ≤ 1.
struct ProjectiveRoot {
  double x;
  bool reciprocal;
  bool touching;  ///< the polynomial comes within `noise` of zero: two roots, one or none
};

struct ProjectiveRoots {
  std::array<ProjectiveRoot, 16> roots;
  int count = 0;
};

/// Real roots of a polynomial of nominal degree 1 to 8 (constant term first; a zero leading coefficient is a root at
/// infinity, higher coefficients must be zero), `noise` being the errors of its coefficients. Coefficients must be
/// finite. In s and in 1 / s, [-1, 1] is halved until the Bernstein coefficients of the polynomial change sign at most
/// once (Descartes' rule); the root is then found by Newton steps inside the bracket.
ProjectiveRoots realRootsByBernstein(const std::array<double, 9>& coefficients, int degree,
                                     const std::array<double, 9>& noise);

}  // namespace multicam_egomotion
