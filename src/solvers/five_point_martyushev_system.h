// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>

#include "multicam_egomotion/geometry/ray.h"

namespace multicam_egomotion {

/// Generalized epipolar constraints of five correspondences, M(n) v = 0, as functions of the rotation axis n:
/// M(n) = rows [(R x1) × x2, x2 · R q1 + q2 · R x1] columns, v = columns⁻¹ [t; 1]. Rows and columns are scaled and
/// turned so that at small angles too M(I), which nearly loses rank, and the part due to R - I are of one order. Axes
/// are given in a frame turned from the body's.
class AxisSystem {
 public:
  using Matrix54 = Eigen::Matrix<double, 5, 4>;
  /// Entry (i, j) of M in row 4 i + j, over the functions 1, x, y, z, x², y², xy, xz, yz of the axis.
  using Coefficients = Eigen::Matrix<double, 20, 9, Eigen::RowMajor>;

  struct Solution {
    Eigen::Vector3d axis;
    Eigen::Vector4d v;
  };

  AxisSystem(const std::array<RayCorrespondence, 5>& sample, double angle);

  const Coefficients& coefficients() const { return coefficients_; }
  bool finite() const { return coefficients_.allFinite(); }
  double angle() const { return angle_; }
  const Eigen::Vector4d& singularValues() const { return singular_values_; }  ///< of M at R = I, relative

  Matrix54 at(const Eigen::Vector3d& axis) const;
  Matrix54 derivative(const Eigen::Vector3d& axis, const Eigen::Vector3d& direction) const;
  Eigen::Matrix3d rotation(const Eigen::Vector3d& axis) const;  ///< in the body frame
  /// [t; 1] up to its scale, in the body frame.
  Eigen::Vector4d translation(const Eigen::Vector4d& v) const { return columns_ * v; }

  /// Null vector of M at an approximate axis.
  Solution start(const Eigen::Vector3d& axis) const;
  /// Newton's method for axis and null vector. False if it does not converge.
  bool refine(Solution& solution) const;
  /// A start for the other one of two solutions that are near each other. False if none is near.
  bool companion(const Solution& solution, Solution& other) const;

 private:
  using Matrix5 = Eigen::Matrix<double, 5, 5>;
  using Vector5 = Eigen::Matrix<double, 5, 1>;
  struct Chart;

  void jacobian(const Solution& solution, Chart& chart) const;

  Coefficients coefficients_;
  Eigen::Matrix4d columns_;
  Eigen::Vector4d singular_values_;
  double angle_;
};

}  // namespace multicam_egomotion
