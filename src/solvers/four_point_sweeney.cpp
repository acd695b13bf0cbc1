// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "multicam_egomotion/solvers/four_point_sweeney.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "epipolar_poses.h"
#include "epipolar_system.h"

#pragma GCC diagnostic ignored "-Wpsabi"

namespace multicam_egomotion {
namespace {

#include "francis_eigenvalues.inc"

// Angles at which the leading N x N block of M(θ) is singular: the eigenvalues u = tan((θ - θ0) / 2) of
// u² A + u B + C, linearized to u z = L z with z = [v; u v]. The leading coefficient A is M opposite to `start` (θ0),
// where it must not be singular. What is known beforehand is divided out: modulo the eigenvectors
// [v; ±i v] with v = [1, ±i, 0, ...], of the factor 1 + s² of det M, the unit vectors e(N) and e(N + 1) are -e(1) and
// e(0); `with_identity`, modulo [v; u0 v] with v = [0, 0, 0, 1] at θ = 0, R = I in every intra-camera sample, e(3) is
// -u0 e(2 N - 1).
template <int N, bool with_identity>
void singularAngles(const EpipolarSystem& system, const HalfAngle& start, AngleEstimates& estimates) {
  using Block = Eigen::Matrix<double, N, N>;
  constexpr int kTop = with_identity ? N - 1 : N, kSize = kTop + N - 2;
  const double c0 = start.a * start.a - start.b * start.b, s0 = 2 * start.a * start.b;
  const Block c = (c0 * system.c + s0 * system.s).template topLeftCorner<N, N>();
  const Block s = (c0 * system.s - s0 * system.c).template topLeftCorner<N, N>();
  const Block k = system.k.template topLeftCorner<N, N>();
  const Block inverse = (c - k).inverse();
  const Block lower_left = inverse * (k + c);
  const Eigen::Matrix<double, N, N - 2> lower_right = 2 * inverse * s.template rightCols<N - 2>();
  SquareMatrix<kSize> reduced = {};
  for (int j = 0; j < kSize; ++j) {
    const auto below = [&](int i) { return j < kTop ? lower_left(i, j) : lower_right(i, j - kTop); };
    double* column = reduced.column[j];
    column[0] = below(1);
    column[1] = -below(0);
    for (int i = 2; i < N; ++i) column[kTop + i - 2] = below(i);
    if (j >= kTop && j - kTop + 2 < kTop) column[j - kTop + 2] += 1;
  }
  if (with_identity) reduced.column[kSize - 1][kSize - 1] += start.b / start.a;
  Hessenberg<kSize> hessenberg;
  reduceToHessenberg(reduced, hessenberg);
  Spectrum<kSize> spectrum;
  eigenvalues(hessenberg.h, spectrum);

  constexpr double kNearlyReal = 1e-3;  // rounding makes a complex pair of a double root and the reverse
  for (int i = 0; i < spectrum.count; ++i) {
    const double x = spectrum.re[i], y = spectrum.im[i];
    if (y < 0 || y > kNearlyReal * (1 + x * x)) continue;  // of a pair one is enough
    estimates.add(normalized(start.a - start.b * x, start.b + start.a * x), y != 0);
  }
}

}  // namespace

PoseCandidates<8> solveFourPointSweeney(const std::array<RayCorrespondence, 4>& sample, const AxisPrior& prior,
                                        const SolverOptions& options) {
  PoseCandidates<8> candidates;
  if (!prior.axis.allFinite()) {
    candidates.status = SolverStatus::kInvalidInput;
    return candidates;
  }
  if (!(prior.axis.squaredNorm() > 1e-24)) {
    candidates.status = SolverStatus::kAxisUndefined;
    return candidates;
  }
  const Eigen::Matrix3d R_aligned_body = rotationToZ(prior.axis);
  EpipolarSystem system;
  candidates.status = buildEpipolarSystem(sample, {R_aligned_body, R_aligned_body}, options, system);
  if (candidates.status != SolverStatus::kOk) return candidates;
  if (system.standing_still) {
    candidates.poses[candidates.count++] = standingStill();
    return candidates;
  }
  if (vanishes(system)) {
    candidates.status = SolverStatus::kCentral;
    return candidates;
  }
  AngleEstimates estimates;
  const HalfAngle regular = farthestFromSingular(system);
  const HalfAngle start = {-regular.b, regular.a};
  if (system.three_and_one) {
    singularAngles<3, false>(system, start, estimates);
  } else if (system.identity_root) {
    singularAngles<4, true>(system, start, estimates);
  } else {
    singularAngles<4, false>(system, start, estimates);
  }
  posesAtRoots(system, estimates, options, candidates);
  return candidates;
}

}  // namespace multicam_egomotion
