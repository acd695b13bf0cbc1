// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "multicam_egomotion/geometry/ray.h"
#include "multicam_egomotion/solvers/solver_priors.h"

namespace multicam_egomotion {

/// Yaws at which the four generalized epipolar constraints in [t; 1] are singular, in extended precision and by the
/// plainest method: the determinant as a polynomial, its roots between the roots of its derivative, by bisection.
struct ReferenceAngles {
  std::vector<double> angles;  ///< R = R_aligned_body2ᵀ Rz(angle) R_aligned_body1 [rad]
  std::vector<double> slopes;  ///< of the determinant of rows of order 1 at these angles, absolute
  bool decided = true;         ///< false: whether two roots are real is a matter of the rounding of the input
};

using Real = long double;
using RealPolynomial = std::vector<Real>;  // constant term first
using RealMatrix3 = Eigen::Matrix<Real, 3, 3>;
using RealMatrix4 = Eigen::Matrix<Real, 4, 4>;

inline Real valueOf(const RealPolynomial& p, Real x) {
  Real value = 0;
  for (size_t k = p.size(); k-- > 0;) value = value * x + p[k];
  return value;
}

inline RealPolynomial product(const RealPolynomial& a, const RealPolynomial& b) {
  RealPolynomial c(a.size() + b.size() - 1, 0);
  for (size_t i = 0; i < a.size(); ++i) {
    for (size_t j = 0; j < b.size(); ++j) c[i + j] += a[i] * b[j];
  }
  return c;
}

/// Roots in [-1, 1], and whether an extremum there is too near zero to tell.
inline std::vector<Real> rootsInUnitInterval(const RealPolynomial& p, Real noise, bool* decided = nullptr) {
  if (p.size() < 2) return {};
  RealPolynomial derivative;
  for (size_t k = 1; k < p.size(); ++k) derivative.push_back(k * p[k]);
  std::vector<Real> nodes = {-1};
  for (Real x : rootsInUnitInterval(derivative, 0)) nodes.push_back(x);
  nodes.push_back(1);
  std::vector<Real> roots;
  for (size_t i = 1; i < nodes.size(); ++i) {
    Real lo = nodes[i - 1], hi = nodes[i];
    const bool negative = valueOf(p, lo) < 0;
    if (decided != nullptr && i > 1 && std::abs(valueOf(p, lo)) < noise) *decided = false;
    if (negative == (valueOf(p, hi) < 0)) continue;
    for (int step = 0; step < 70; ++step) {
      const Real middle = (lo + hi) / 2;
      ((valueOf(p, middle) < 0) == negative ? lo : hi) = middle;
    }
    roots.push_back((lo + hi) / 2);
  }
  return roots;
}

/// All real roots as s = numerator / denominator.
inline std::vector<std::array<Real, 2>> projectiveRoots(const RealPolynomial& p, Real noise, bool& decided) {
  std::vector<std::array<Real, 2>> roots;
  for (Real x : rootsInUnitInterval(p, noise, &decided)) roots.push_back({x, 1});
  for (Real x : rootsInUnitInterval(RealPolynomial(p.rbegin(), p.rend()), noise, &decided)) {
    if (std::abs(x) < 1) roots.push_back({1, x});
  }
  return roots;
}

/// Determinant of the first `n` rows and columns of Σ coefficients[k] x^k, by permutations.
inline RealPolynomial determinantOf(const std::vector<RealMatrix4>& coefficients, int n) {
  std::vector<int> permutation(n);
  for (int i = 0; i < n; ++i) permutation[i] = i;
  RealPolynomial sum((coefficients.size() - 1) * n + 1, 0);
  do {
    int inversions = 0;
    for (int i = 0; i < n; ++i) {
      for (int j = 0; j < i; ++j) inversions += permutation[j] > permutation[i];
    }
    RealPolynomial term = {inversions % 2 ? Real(-1) : Real(1)};
    for (int i = 0; i < n; ++i) {
      RealPolynomial entry;
      for (const RealMatrix4& coefficient : coefficients) entry.push_back(coefficient(i, permutation[i]));
      term = product(term, entry);
    }
    for (size_t k = 0; k < sum.size(); ++k) sum[k] += term[k];
  } while (std::next_permutation(permutation.begin(), permutation.end()));
  return sum;
}

/// Rows [R x1 × x2, (R x1) · q2 + x2 · (R q1)] for any matrix Rz between the aligned frames; the last column relative
/// to the largest moment. The third row of the sample, which is the odd one of the 3+1 samples, comes last.
inline RealMatrix4 classicalRows(const std::array<RayCorrespondence, 4>& rays, const VerticalPrior& aligned,
                                 const RealMatrix3& Rz) {
  const RealMatrix3 R = aligned.R_aligned_body2.cast<Real>().transpose() * Rz * aligned.R_aligned_body1.cast<Real>();
  RealMatrix4 rows;
  Real size = 0;
  for (int i = 0; i < 4; ++i) {
    const RayCorrespondence& ray = rays[std::array<int, 4>{0, 1, 3, 2}[i]];
    const auto x1 = ray.first.direction.cast<Real>().eval(), x2 = ray.second.direction.cast<Real>().eval();
    const auto q1 = ray.first.moment.cast<Real>().eval(), q2 = ray.second.moment.cast<Real>().eval();
    rows.row(i).head<3>() = (R * x1).eval().cross(x2).transpose();
    rows(i, 3) = (R * x1).dot(q2) + x2.dot(R * q1);
    size = std::max({size, q1.norm(), q2.norm()});
  }
  rows.col(3) /= size;
  return rows;
}

inline RealMatrix3 aboutZ(Real c, Real s, Real z) {
  RealMatrix3 R;
  R << c, -s, 0, s, c, 0, 0, 0, z;
  return R;
}

/// |d/dφ| at tan φ = numerator / denominator of the polynomial made homogeneous in (sin φ, cos φ).
inline double slopeAt(const RealPolynomial& p, const std::array<Real, 2>& root) {
  const int degree = static_cast<int>(p.size()) - 1;
  const Real length = std::hypot(root[0], root[1]), s = root[0] / length, c = root[1] / length;
  Real slope = 0;
  for (int k = 0; k <= degree; ++k) {
    if (k > 0) slope += k * p[k] * std::pow(s, k - 1) * std::pow(c, degree - k + 1);
    if (k < degree) slope -= (degree - k) * p[k] * std::pow(s, k + 1) * std::pow(c, degree - k - 1);
  }
  return static_cast<double>(std::abs(slope));
}

/// Leaves out the root nearest zero: R = I of intra-camera samples.
inline void leaveOutIdentity(ReferenceAngles& reference) {
  std::vector<double>& angles = reference.angles;
  if (angles.empty()) return;
  const auto identity =
      std::min_element(angles.begin(), angles.end(), [](double a, double b) { return std::abs(a) < std::abs(b); });
  reference.slopes.erase(reference.slopes.begin() + (identity - angles.begin()));
  angles.erase(identity);
}

constexpr Real kUndecided = 1e-14L;  // extremum of a determinant of rows of order 1 that may be zero

/// `three_and_one`: the third correspondence is of another camera pair than the others, whose normals alone are meant.
/// `identity`: R = I solves the sample and is left out (with three_and_one the normals do not know it).
inline ReferenceAngles referenceAngles(const std::array<RayCorrespondence, 4>& rays, const VerticalPrior& aligned,
                                       bool three_and_one, bool identity) {
  // (1 + s²) Rz = s² Rz(π) + 2 s [z]× + Rz(0)
  const std::vector<RealMatrix4> quadratic = {classicalRows(rays, aligned, aboutZ(1, 0, 1)),
                                              classicalRows(rays, aligned, aboutZ(0, 2, 0)),
                                              classicalRows(rays, aligned, aboutZ(-1, 0, 1))};
  RealPolynomial p = determinantOf(quadratic, three_and_one ? 3 : 4);
  // Divided by 1 + s².
  for (size_t k = p.size(); k-- > 2;) p[k - 2] -= p[k];
  p.erase(p.begin(), p.begin() + 2);
  ReferenceAngles reference;
  for (const auto& root : projectiveRoots(p, kUndecided, reference.decided)) {
    reference.angles.push_back(std::remainder(static_cast<double>(2 * std::atan2(root[0], root[1])), 2 * M_PI));
    reference.slopes.push_back(0.5 * slopeAt(p, root));
  }
  if (identity && !three_and_one) leaveOutIdentity(reference);
  return reference;
}

/// The same to first order about the yaw at which R turns least: Rz(φ) (I + θ [z]×).
inline ReferenceAngles referenceLiuAngles(const std::array<RayCorrespondence, 4>& rays, const VerticalPrior& aligned,
                                          bool identity) {
  const RealMatrix3 between = aligned.R_aligned_body2.cast<Real>() * aligned.R_aligned_body1.cast<Real>().transpose();
  const Real yaw = std::atan2(between(1, 0) - between(0, 1), between(0, 0) + between(1, 1));
  const Real c = std::cos(yaw), s = std::sin(yaw);
  const std::vector<RealMatrix4> linear = {classicalRows(rays, aligned, aboutZ(c, s, 1)),
                                           classicalRows(rays, aligned, aboutZ(-s, c, 0))};
  ReferenceAngles reference;
  const RealPolynomial p = determinantOf(linear, 4);
  for (const auto& root : projectiveRoots(p, kUndecided, reference.decided)) {
    reference.angles.push_back(std::atan(static_cast<double>(root[0] / root[1])));
    reference.slopes.push_back(slopeAt(p, root));
  }
  if (identity) leaveOutIdentity(reference);
  for (double& angle : reference.angles) angle = std::remainder(angle + static_cast<double>(yaw), 2 * M_PI);
  return reference;
}

inline double yawBetween(const VerticalPrior& aligned, const Eigen::Matrix3d& R) {
  const Eigen::Matrix3d Rz = aligned.R_aligned_body2 * R * aligned.R_aligned_body1.transpose();
  return std::atan2(Rz(1, 0) - Rz(0, 1), Rz(0, 0) + Rz(1, 1));
}

inline double distanceToNearest(const std::vector<double>& angles, double angle) {
  double smallest = std::numeric_limits<double>::infinity();
  for (double a : angles) smallest = std::min(smallest, std::abs(std::remainder(a - angle, 2 * M_PI)));
  return smallest;
}

}  // namespace multicam_egomotion
