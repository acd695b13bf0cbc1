// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

namespace multicam_egomotion {

/// Real spherical harmonics Y_lm, index l² + l + m, of mean square 1 on the unit sphere: an orthonormal basis of the
/// polynomials in the axis n. Y_0 = 1, Y_1..3 = √3 (y, z, x).
namespace sphere {

constexpr int kDegree6 = 49;   ///< number of functions of degree ≤ 6
constexpr int kDegree7 = 64;   ///< of degree ≤ 7
constexpr int kDegree8 = 81;   ///< of degree ≤ 8
constexpr int kQuadratic = 9;  ///< of degree ≤ 2
constexpr int kPoints = 112;   ///< 7 Gauss-Legendre heights x 16 azimuths: exact to degree 13

struct Product {
  int row;       ///< of degree ≤ 8
  int column;    ///< of degree ≤ 6
  double value;  ///< mean of Y_row Y_factor Y_column
};

struct Tables {
  alignas(64) double quadratic[kQuadratic][kPoints];     ///< 1, x, y, z, x², y², xy, xz, yz
  alignas(64) double projection[kPoints][kDegree6 + 3];  ///< weight times Y of degree ≤ 6; zeros fill the row
  double z_coupling[9][17];  ///< z Y_lm = c(l + 1, m) Y_(l+1)m + c(l, m) Y_(l-1)m, c(l, m) = z_coupling[l][l + m]
  std::vector<Product> times[kQuadratic];  ///< multiplication of functions of degree ≤ 6 by Y_factor
};

/// Computed once.
const Tables& tables();

}  // namespace sphere
}  // namespace multicam_egomotion
