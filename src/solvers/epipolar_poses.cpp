// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "epipolar_poses.h"

#include <Eigen/Geometry>
#include <cmath>

#include "four_point_translation.h"

namespace multicam_egomotion {
namespace {

constexpr int kMaxSolutions = 6;
constexpr double kSettled = 1e-9;        // [rad], of the last Newton step
constexpr double kLargestStep = 0.02;    // [rad]
constexpr double kSameRoot = 1e-9;       // [rad]; roots this near are one to rounding
constexpr double kNeighbour = 0.01;      // [rad]
constexpr double kRankTolerance = 1e-8;  // volume of three rows below which all four are looked at
constexpr double kFarthest = 1e6;        // |t| / size beyond which all rows are looked at

HalfAngle turned(const HalfAngle& half, double angle) {
  return normalized(half.a - 0.5 * angle * half.b, half.b + 0.5 * angle * half.a);
}

// Angle between two rotations about z, for small ones.
double difference(const HalfAngle& from, const HalfAngle& to) {
  const double aligned = from.a * to.a + from.b * to.b;
  return 2 * std::copysign(1.0, aligned) * (from.a * to.b - from.b * to.a);
}

// Newton steps towards a root, in which neighbouring roots are divided out (Aberth), so that no two estimates settle on
// the same one.
bool refine(const EpipolarSystem& system, const AngleEstimates& estimates, int index, HalfAngle& half,
            SystemAtAngle& at) {
  constexpr int kIterations = 12;
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    at = evaluate(system, half);
    double step = at.value / at.slope, repulsion = 0;
    for (int j = 0; j < estimates.count; ++j) {
      const double gap = difference(estimates.angles[j].half, half);
      if (j != index && !estimates.angles[j].touching && std::abs(gap) < kNeighbour && gap != 0) repulsion += 1 / gap;
    }
    step /= 1 - step * repulsion;
    if (!(std::abs(step) < kLargestStep)) return false;
    half = turned(half, -step);
    if (std::abs(step) < kSettled) {
      // So short a step moves the rows along their slopes.
      at.rows -= step * at.row_slopes;
      if (system.identity_root) at.factor = 2 * half.b;
      return true;
    }
  }
  return false;
}

// Where det M comes near zero without changing its sign: its extremum decides between two roots, a double one and none.
int rootsAtExtremum(const EpipolarSystem& system, HalfAngle half, HalfAngle* roots) {
  constexpr double kDifference = 1e-4;
  constexpr int kIterations = 10;
  double step = kLargestStep, curvature = 0;
  for (int i = 0; i < kIterations && std::abs(step) > 1e-13; ++i) {
    const SystemAtAngle after = evaluate(system, turned(half, kDifference));
    const SystemAtAngle before = evaluate(system, turned(half, -kDifference));
    curvature = (after.slope - before.slope) / (2 * kDifference);
    step = evaluate(system, half).slope / curvature;
    if (!(std::abs(step) < kLargestStep)) return 0;
    half = turned(half, -step);
  }
  const SystemAtAngle at = evaluate(system, half);
  if (std::abs(at.value) <= roundingError(system, at)) {
    roots[0] = half;
    return 1;
  }
  const double square = -2 * at.value / curvature;
  if (!(square > 0)) return 0;
  roots[0] = turned(half, std::sqrt(square));
  roots[1] = turned(half, -std::sqrt(square));
  return 2;
}

// How many of the eight depths are positive; `direction_only`: at the scale at which the camera centres coincide.
int positiveDepths(const EpipolarSystem& system, double c, double s, const Eigen::Vector3d& t, bool direction_only) {
  constexpr double kTolerance = -1e-14;  // a point without parallax lies at infinity, where rounding decides the sign
  const LaneVectors &x = system.x1, &b = system.x2, &p1 = system.p1, &p2 = system.p2;
  const LaneVectors a = {c * x[0] - s * x[1], s * x[0] + c * x[1], x[2]};
  LaneVectors d = {Lanes::Constant(-t.x()), Lanes::Constant(-t.y()), Lanes::Constant(-t.z())};
  if (!direction_only) {
    d[0] += p2[0] - (c * p1[0] - s * p1[1]);
    d[1] += p2[1] - (s * p1[0] + c * p1[1]);
    d[2] += p2[2] - p1[2];
  }
  const LaneVectors n = cross(a, b), u = cross(d, b), v = cross(d, a);
  const Lanes depth1 = u[0] * n[0] + u[1] * n[1] + u[2] * n[2], depth2 = v[0] * n[0] + v[1] * n[1] + v[2] * n[2];
  return static_cast<int>((depth1 > kTolerance).count() + (depth2 > kTolerance).count());
}

// Translation where three rows do not give it: of all that have parallax.
bool translationFromAllRows(const Eigen::Matrix4d& all_rows, Eigen::Vector3d& t, bool& scale_observable) {
  Eigen::Matrix4d rows = Eigen::Matrix4d::Zero();
  int used = 0;
  for (int i = 0; i < 4; ++i) {
    const double parallax = all_rows.row(i).head<3>().norm();
    if (parallax > kNoParallax) rows.row(used++) = all_rows.row(i) / parallax;
  }
  return leastSquaresTranslation(rows, t, scale_observable);
}

}  // namespace

RelativePose standingStill() { return {Eigen::Matrix3d::Identity(), Eigen::Vector3d::Zero(), false}; }

bool depthsArePositive(const EpipolarSystem& system, const HalfAngle& half, const Eigen::Vector3d& t_aligned,
                       bool scale_observable) {
  const double c = half.a * half.a - half.b * half.b, s = 2 * half.a * half.b;
  return positiveDepths(system, c, s, t_aligned, !scale_observable) == 8;
}

bool poseFromRows(const EpipolarSystem& system, const HalfAngle& half, const Eigen::Matrix4d& rows,
                  const Eigen::Matrix4d& cofactors, double factor, const SolverOptions& options, RelativePose& pose) {
  const double c = half.a * half.a - half.b * half.b, s = 2 * half.a * half.b;
  Eigen::Matrix3d Rz;
  Rz << c, -s, 0, s, c, 0, 0, 0, 1;

  // The longest row of cofactors belongs to the row of M that says least.
  Eigen::Index left_out;
  const double longest = cofactors.rowwise().squaredNorm().maxCoeff(&left_out);
  const Eigen::Vector4d null_vector = cofactors.row(left_out).transpose();
  double volume = 1;
  for (int i = 0; i < 4; ++i) {
    if (i != left_out) volume *= rows.row(i).squaredNorm();
  }
  const double direction = null_vector.head<3>().squaredNorm(), constant = null_vector(3) * null_vector(3);
  pose.scale_observable = std::abs(factor) > kScaleTolerance;
  const bool finite = pose.scale_observable ? constant * kFarthest * kFarthest > direction
                                            : direction * kFarthest * kFarthest > constant;
  Eigen::Vector3d t;
  if (longest > kRankTolerance * kRankTolerance * volume && finite) {
    t = pose.scale_observable ? Eigen::Vector3d(null_vector.head<3>() * (factor / null_vector(3)))
                              : Eigen::Vector3d(null_vector.head<3>() / std::sqrt(direction));
  } else {
    Eigen::Matrix4d undivided = rows;
    undivided.col(3) *= factor;
    if (!translationFromAllRows(undivided, t, pose.scale_observable)) return false;
  }
  if (pose.scale_observable) {
    t *= system.size;
  } else if (positiveDepths(system, c, s, t, true) < 4) {
    t = -t;
  }
  if (options.positive_depths_only && !depthsArePositive(system, half, t, pose.scale_observable)) return false;
  const Eigen::Matrix3d Rz_body1 = Rz * system.R_aligned_body1;
  pose.R.noalias() = system.R_aligned_body2.transpose() * Rz_body1;
  pose.t.noalias() = system.R_aligned_body2.transpose() * t;
  return true;
}

void posesAtRoots(const EpipolarSystem& system, AngleEstimates& estimates, const SolverOptions& options,
                  PoseCandidates<8>& candidates) {
  std::array<HalfAngle, kMaxSolutions> roots;
  int count = 0;
  const auto addRoot = [&](const HalfAngle& root, const SystemAtAngle& at) {
    for (int i = 0; i < count; ++i) {
      if (std::abs(difference(roots[i], root)) < kSameRoot) return;
    }
    if (count == kMaxSolutions) return;
    roots[count++] = root;
    RelativePose& pose = candidates.poses[candidates.count];
    candidates.count += poseFromRows(system, root, at.rows, cofactorMatrix(at.rows), at.factor, options, pose);
  };

  SystemAtAngle at;
  for (int i = 0; i < estimates.count; ++i) {
    AngleEstimate& estimate = estimates.angles[i];
    HalfAngle half = estimate.half;
    if (!estimate.touching && refine(system, estimates, i, half, at)) {
      estimate.half = half;
      addRoot(half, at);
    } else {
      estimate.touching = true;
    }
  }
  for (int i = 0; i < estimates.count; ++i) {
    if (!estimates.angles[i].touching) continue;
    HalfAngle pair[2];
    const int found = rootsAtExtremum(system, estimates.angles[i].half, pair);
    AngleEstimates both;
    for (int k = 0; k < found; ++k) both.add(pair[k], false);
    for (int k = 0; k < found; ++k) {
      HalfAngle half = pair[k];
      if (found == 2 && refine(system, both, k, half, at)) {
        addRoot(half, at);
        continue;
      }
      at = evaluate(system, pair[k]);
      if (std::abs(at.value) <= roundingError(system, at)) addRoot(pair[k], at);
    }
  }
}

}  // namespace multicam_egomotion
