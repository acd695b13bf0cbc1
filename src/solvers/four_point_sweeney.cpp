// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "multicam_egomotion/solvers/four_point_sweeney.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>
#include <complex>

#include "epipolar_poses.h"
#include "epipolar_system.h"

namespace multicam_egomotion {
namespace {

// Angles at which the leading N x N block of M(θ) is singular: the eigenvalues u = tan((θ - θ0) / 2) of
// u² A + u B + C. The leading coefficient A is M opposite to `start` (θ0), where it must not be singular.
template <int N>
void singularAngles(const EpipolarSystem& system, const HalfAngle& start, AngleEstimates& estimates) {
  using Block = Eigen::Matrix<double, N, N>;
  using Linearization = Eigen::Matrix<double, 2 * N, 2 * N>;
  const double c0 = start.a * start.a - start.b * start.b, s0 = 2 * start.a * start.b;
  const Block c = (c0 * system.c + s0 * system.s).template topLeftCorner<N, N>();
  const Block s = (c0 * system.s - s0 * system.c).template topLeftCorner<N, N>();
  const Block k = system.k.template topLeftCorner<N, N>();
  const Eigen::PartialPivLU<Block> A(k - c);
  Linearization companion;
  companion.template topLeftCorner<N, N>().setZero();
  companion.template topRightCorner<N, N>().setIdentity();
  companion.template bottomLeftCorner<N, N>() = -A.solve(k + c);
  companion.template bottomRightCorner<N, N>() = -A.solve(2 * s);
  const Eigen::EigenSolver<Linearization> solver(companion, false);
  if (solver.info() != Eigen::Success) return;
  const Eigen::Matrix<std::complex<double>, 2 * N, 1> u = solver.eigenvalues();

  // R = I, the solution of every intra-camera sample, is left out once: the eigenvalue whose half angle has the
  // smallest sine.
  int identity = -1;
  if (N == 4 && system.identity_root) {
    double smallest = 2;
    for (int i = 0; i < 2 * N; ++i) {
      const double square = std::norm(start.b + start.a * u(i)) / (1 + std::norm(u(i)));
      if (square < smallest) {
        smallest = square;
        identity = i;
      }
    }
  }
  constexpr double kNearlyReal = 1e-3;  // rounding makes a complex pair of a double root and the reverse
  for (int i = 0; i < 2 * N; ++i) {
    const double x = u(i).real(), y = u(i).imag();
    if (i == identity || std::abs(y) > kNearlyReal * (1 + x * x)) continue;
    const bool of_identity = identity >= 0 && u(i) == std::conj(u(identity));
    if (y < 0 && !of_identity) continue;  // of a pair one is enough
    estimates.add(normalized(start.a - start.b * x, start.b + start.a * x), y != 0 && !of_identity);
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
    singularAngles<3>(system, start, estimates);
  } else {
    singularAngles<4>(system, start, estimates);
  }
  posesAtRoots(system, estimates, options, candidates);
  return candidates;
}

}  // namespace multicam_egomotion
