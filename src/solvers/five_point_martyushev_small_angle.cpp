// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/LU>
#include <algorithm>

#include "five_point_martyushev_axes.h"
#include "multicam_egomotion/solvers/polynomial_roots.h"

namespace multicam_egomotion {
namespace {

/// Polynomial of degree ≤ Degree, constant term first.
template <int Degree>
using PolynomialVector = Eigen::Matrix<double, Degree + 1, 1>;

template <int M, int N>
Eigen::Matrix<double, M + N - 1, 1> product(const Eigen::Matrix<double, M, 1>& a,
                                            const Eigen::Matrix<double, N, 1>& b) {
  Eigen::Matrix<double, M + N - 1, 1> result = Eigen::Matrix<double, M + N - 1, 1>::Zero();
  for (int i = 0; i < M; ++i) result.template segment<N>(i) += a(i) * b;
  return result;
}

using LinearColumn = std::array<PolynomialVector<1>, 3>;

/// a · (b × c) of columns affine in s.
PolynomialVector<3> determinant(const LinearColumn& a, const LinearColumn& b, const LinearColumn& c) {
  PolynomialVector<3> result = PolynomialVector<3>::Zero();
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    const PolynomialVector<2> cross = product(b[j], c[k]) - product(b[k], c[j]);
    result += product(a[i], cross);
  }
  return result;
}

using Block = Eigen::Matrix<double, 3, 2>;

/// Block that has rank 1 where M has rank 3, expanded to first order about `center`: over 1, x, y, z.
std::array<Block, 4> expandBlock(const AxisSystem& system, const Eigen::Vector3d& center) {
  AxisSystem::Matrix54 constant = system.at(center), linear[3];
  Eigen::Matrix<double, 3, 5> left;
  Eigen::Matrix<double, 4, 2> right;
  const Eigen::Matrix2d inverse = constant.topLeftCorner<2, 2>().inverse();
  left << -constant.bottomLeftCorner<3, 2>() * inverse, Eigen::Matrix3d::Identity();
  right << -inverse * constant.topRightCorner<2, 2>(), Eigen::Matrix2d::Identity();
  for (int k = 0; k < 3; ++k) {
    linear[k] = system.derivative(center, Eigen::Vector3d::Unit(k));
    constant -= center(k) * linear[k];
  }
  return {left * constant * right, left * linear[0] * right, left * linear[1] * right, left * linear[2] * right};
}

/// Appends the axes at which the expanded block has rank 1, those within `radius` of `center`.
void solveAbout(const AxisSystem& system, const Eigen::Vector3d& center, double radius, ApproximateAxes& result) {
  // Columns of block(n) [1 s]ᵀ over 1, x, y, z.
  const std::array<Block, 4> block = expandBlock(system, center);
  LinearColumn columns[4];
  for (int function = 0; function < 4; ++function) {
    for (int row = 0; row < 3; ++row) columns[function][row] = block[function].row(row).transpose();
  }
  // Cramer's rule
  const PolynomialVector<3> denominator = determinant(columns[1], columns[2], columns[3]);
  const PolynomialVector<3> numerators[3] = {-determinant(columns[0], columns[2], columns[3]),
                                             -determinant(columns[1], columns[0], columns[3]),
                                             -determinant(columns[1], columns[2], columns[0])};
  PolynomialVector<6> sphere = -product(denominator, denominator);
  for (const PolynomialVector<3>& numerator : numerators) sphere += product(numerator, numerator);

  const auto add = [&](double x, bool reciprocal) {
    double powers[4] = {1, x, x * x, x * x * x};
    if (reciprocal) std::reverse(powers, powers + 4);
    const Eigen::Map<const PolynomialVector<3>> s(powers);
    const Eigen::Vector3d axis =
        Eigen::Vector3d(numerators[0].dot(s), numerators[1].dot(s), numerators[2].dot(s)) / denominator.dot(s);
    const bool usable = axis.squaredNorm() > 0.25 && axis.squaredNorm() < 4 && (axis - center).norm() < radius;
    if (usable) result.add(axis.normalized());
  };
  std::array<double, 7> coefficients = {}, slope = {};
  for (int i = 0; i <= 6; ++i) coefficients[i] = sphere(i);
  for (int i = 0; i < 6; ++i) slope[i] = (i + 1) * sphere(i + 1);
  const RealRoots roots = findRealRoots(coefficients);
  for (int i = 0; i < roots.count; ++i) add(roots.x[i], roots.reciprocal[i]);
  // Two axes near each other may have been lost in the approximation.
  const RealRoots extrema = findRealRoots(slope, 5);
  for (int i = 0; i < extrema.count; ++i) add(extrema.x[i], extrema.reciprocal[i]);
}

}  // namespace

void smallAngleAxes(const AxisSystem& system, ApproximateAxes& result) {
  constexpr double kEverywhere = 10, kNear = 0.5;
  ApproximateAxes coarse;
  solveAbout(system, Eigen::Vector3d::Zero(), kEverywhere, coarse);
  for (int i = 0; i < coarse.count; ++i) solveAbout(system, coarse.axes[i], kNear, result);
}

}  // namespace multicam_egomotion
