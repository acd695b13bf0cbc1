// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "multicam_egomotion/solvers/four_point_lee.h"

#include <cmath>

#include "bernstein_roots.h"
#include "epipolar_poses.h"
#include "epipolar_system.h"

namespace multicam_egomotion {
namespace {

// Polynomial in s with N coefficients, constant term first.
template <int N>
struct Polynomial {
  double c[N] = {};
};

template <int N, int M>
void addProduct(const Polynomial<N>& a, const Polynomial<M>& b, double sign, Polynomial<N + M - 1>& sum) {
  for (int i = 0; i < N; ++i) {
    for (int j = 0; j < M; ++j) sum.c[i + j] += sign * a.c[i] * b.c[j];
  }
}

using Quadratic = Polynomial<3>;
using Column = std::array<Quadratic, 4>;

// A column of (1 + s²) M(s); of the last one with the identity root, s = tan(θ / 2) is taken out.
Column columnOf(const EpipolarSystem& system, int column) {
  const bool divided = column == 3 && system.identity_root;
  Column result;
  for (int i = 0; i < 4; ++i) {
    const double c = system.c(i, column), s = system.s(i, column), k = system.k(i, column);
    result[i] = divided ? Quadratic{{2 * s, -2 * c, 0}} : Quadratic{{k + c, 2 * s, k - c}};
  }
  return result;
}

Polynomial<5> minorOf(const Column& a, const Column& b, int row1, int row2) {
  Polynomial<5> minor;
  addProduct(a[row1], b[row2], 1.0, minor);
  addProduct(a[row2], b[row1], -1.0, minor);
  return minor;
}

using Columns = std::array<Column, 4>;
using Coefficients = std::array<double, 9>;

// Laplace expansion by the 2x2 minors of the first and of the last two columns.
Coefficients expand(const Columns& columns) {
  constexpr int kRows[6][4] = {{0, 1, 2, 3}, {0, 2, 1, 3}, {0, 3, 1, 2}, {1, 2, 0, 3}, {1, 3, 0, 2}, {2, 3, 0, 1}};
  constexpr double kSign[6] = {1, -1, 1, 1, -1, 1};
  Polynomial<9> sum;
  for (int i = 0; i < 6; ++i) {
    addProduct(minorOf(columns[0], columns[1], kRows[i][0], kRows[i][1]),
               minorOf(columns[2], columns[3], kRows[i][2], kRows[i][3]), kSign[i], sum);
  }
  Coefficients result;
  for (int k = 0; k < 9; ++k) result[k] = sum.c[k];
  return result;
}

// Three correspondences of one camera pair: det M has the determinant of their normals, of degree 6, for a factor; the
// roots of the other factor are those in which the three meet in their camera centre.
Coefficients expandNormals(const Columns& columns) {
  const auto &x = columns[0], &y = columns[1], &z = columns[2];
  Polynomial<7> sum;
  addProduct(minorOf(x, y, 0, 1), z[2], 1.0, sum);
  addProduct(minorOf(x, y, 0, 2), z[1], -1.0, sum);
  addProduct(minorOf(x, y, 1, 2), z[0], 1.0, sum);
  Coefficients result = {};
  for (int k = 0; k < 7; ++k) result[k] = sum.c[k];
  return result;
}

// Sums of the magnitudes in the first rows of a column.
Quadratic magnitude(const Column& column, int rows) {
  Quadratic sum;
  for (int i = 0; i < rows; ++i) {
    for (int k = 0; k < 3; ++k) sum.c[k] += std::abs(column[i].c[k]);
  }
  return sum;
}

// Rounding errors of the coefficients of a determinant: all its terms are among those of the product of the columns'
// magnitudes.
Coefficients roundingOf(const Columns& columns, bool normals) {
  constexpr double kRounding = 2e-16;
  const int rows = normals ? 3 : 4;
  Polynomial<5> first;
  addProduct(magnitude(columns[0], rows), magnitude(columns[1], rows), kRounding, first);
  Polynomial<7> three;
  addProduct(first, magnitude(columns[2], rows), 1.0, three);
  Polynomial<9> all;
  addProduct(three, normals ? Quadratic{{1, 0, 0}} : magnitude(columns[3], rows), 1.0, all);
  Coefficients result;
  for (int k = 0; k < 9; ++k) result[k] = all.c[k];
  return result;
}

Columns columnsOf(const EpipolarSystem& system) {
  return {columnOf(system, 0), columnOf(system, 1), columnOf(system, 2), columnOf(system, 3)};
}

ProjectiveRoots rootsOfDeterminant(const EpipolarSystem& system) {
  const Columns columns = columnsOf(system);
  const Coefficients noise = roundingOf(columns, system.three_and_one);
  if (system.three_and_one) return realRootsByBernstein(expandNormals(columns), 6, noise);
  return realRootsByBernstein(expand(columns), system.identity_root ? 7 : 8, noise);
}

// The same prior with the yaw of the first aligned frame such that the yaw between the frames is zero where the body
// turns least. There, at small rotations, the roots lie close together, and the coefficients are exact about s = 0.
VerticalPrior countedFromLeastRotation(const VerticalPrior& prior) {
  const Eigen::Matrix3d between = prior.R_aligned_body2 * prior.R_aligned_body1.transpose();
  const double cosine = between(0, 0) + between(1, 1), sine = between(1, 0) - between(0, 1);
  const double length = std::hypot(cosine, sine);
  if (!(length > 1e-3)) return prior;
  Eigen::Matrix3d yaw = Eigen::Matrix3d::Identity();
  yaw.topLeftCorner<2, 2>() << cosine / length, -sine / length, sine / length, cosine / length;
  return {yaw * prior.R_aligned_body1, prior.R_aligned_body2};
}

}  // namespace

PoseCandidates<8> solveFourPointLee(const std::array<RayCorrespondence, 4>& sample, const VerticalPrior& prior,
                                    const SolverOptions& options) {
  PoseCandidates<8> candidates;
  EpipolarSystem system;
  candidates.status = buildEpipolarSystem(sample, countedFromLeastRotation(prior), options, system);
  if (candidates.status != SolverStatus::kOk) return candidates;
  if (system.standing_still) {
    candidates.poses[candidates.count++] = standingStill();
    return candidates;
  }
  if (vanishes(system)) {
    candidates.status = SolverStatus::kCentral;
    return candidates;
  }
  const ProjectiveRoots roots = rootsOfDeterminant(system);
  AngleEstimates estimates;
  for (int i = 0; i < roots.count; ++i) {
    const ProjectiveRoot& root = roots.roots[i];
    estimates.add(root.reciprocal ? normalized(root.x, 1) : normalized(1, root.x), root.touching);
  }
  posesAtRoots(system, estimates, options, candidates);
  return candidates;
}

std::array<double, 9> leePolynomial(const std::array<RayCorrespondence, 4>& sample, const VerticalPrior& prior) {
  EpipolarSystem system;
  if (buildEpipolarSystem(sample, prior, {}, system) != SolverStatus::kOk) return {};
  system.identity_root = false;
  return expand(columnsOf(system));
}

}  // namespace multicam_egomotion
