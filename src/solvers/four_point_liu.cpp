// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "multicam_egomotion/solvers/four_point_liu.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "epipolar_poses.h"
#include "epipolar_system.h"
#include "instruction_sets.h"
#include "quartic_roots.h"
#include "sample_checks.h"

#pragma GCC diagnostic ignored "-Wpsabi"

namespace multicam_egomotion {
namespace {

constexpr double kSmallestSquare = 1e-12;  // of a ray's direction
constexpr double kLargestSquare = 1e200;   // of a moment [m²]
constexpr double kUnit = 1e-13;            // deviation from one
constexpr double kMeeting = 1e-13;         // constraint of two rays through one point, relative to their moments
constexpr double kVanishing = 1e-14;       // determinant of rows of order 1
constexpr double kNoParallax = 1e-7;       // [rad]
constexpr double kScaleTolerance = 1e-7;   // angle without scale [rad]
constexpr double kRankTolerance = 1e-8;    // volume of three rows below which all four are looked at
constexpr double kFarthest = 1e6;          // |t| / size beyond which all rows are looked at

namespace build_instructions {
#include "four_point_liu.inc"
}

#if MULTICAM_EGOMOTION_DISPATCH_AVX2
#pragma GCC push_options
#pragma GCC target("avx2,fma")
namespace avx2_instructions {
#include "four_point_liu.inc"
}
#pragma GCC pop_options
#endif

// Frame 1 turned about the vertical so that R_aligned_body2ᵀ R_aligned_body1, the rotation at θ = 0, is the least: it
// has the largest trace.
Eigen::Matrix3d leastTurned(const VerticalPrior& prior) {
  const Eigen::Matrix3d &R1 = prior.R_aligned_body1, &R2 = prior.R_aligned_body2;
  double c = R2.row(0).dot(R1.row(0)) + R2.row(1).dot(R1.row(1));
  double s = R2.row(1).dot(R1.row(0)) - R2.row(0).dot(R1.row(1));
  const double length = std::sqrt(c * c + s * s);
  if (!(length > 1e-12)) return R1;
  c /= length;
  s /= length;
  Eigen::Matrix3d turned;
  turned.row(0) = c * R1.row(0) - s * R1.row(1);
  turned.row(1) = s * R1.row(0) + c * R1.row(1);
  turned.row(2) = R1.row(2);
  return turned;
}

// What is rare: roots at which three rows do not determine the translation, samples that may not determine the pose,
// and the test of depths.
class ClassicalSystem {
 public:
  ClassicalSystem(const std::array<RayCorrespondence, 4>& sample, const VerticalPrior& prior,
                  const SolverOptions& options)
      : sample_(sample), prior_(prior), options_(options) {}

  bool vanishes() { return multicam_egomotion::vanishes(system()); }

  bool depthsArePositive(double theta, const Eigen::Vector3d& t_aligned) {
    return multicam_egomotion::depthsArePositive(system(), halfOf(theta), t_aligned, true);
  }

  bool poseAt(double theta, RelativePose& pose) {
    const EpipolarSystem& s = system();
    Eigen::Matrix4d rows = s.c + s.k + theta * s.s;
    if (s.identity_root) rows.col(3) = s.s.col(3);
    return poseFromRows(s, halfOf(theta), rows, cofactorMatrix(rows), s.identity_root ? theta : 1.0, options_, pose);
  }

 private:
  const EpipolarSystem& system() {
    if (!built_) buildEpipolarSystem(sample_, prior_, options_, system_);
    built_ = true;
    return system_;
  }

  // Half of atan θ.
  static HalfAngle halfOf(double theta) { return normalized(1 + std::sqrt(1 + theta * theta), theta); }

  const std::array<RayCorrespondence, 4>& sample_;
  const VerticalPrior& prior_;
  const SolverOptions& options_;
  EpipolarSystem system_;
  bool built_ = false;
};

template <typename Solution>
void addPoses(const Solution& solution, const SolverOptions& options, ClassicalSystem& classical,
              PoseCandidates<4>& candidates) {
  const auto& lanes = solution.poses;
  for (int i = 0; i < solution.count; ++i) {
    RelativePose& pose = candidates.poses[candidates.count];
    const double theta = solution.theta[i];
    if (!lanes.determined[i]) {
      candidates.count += std::isfinite(theta) && classical.poseAt(theta, pose);
      continue;
    }
    if (options.positive_depths_only &&
        !classical.depthsArePositive(theta, {lanes.t_aligned[0][i], lanes.t_aligned[1][i], lanes.t_aligned[2][i]})) {
      continue;
    }
    for (int k = 0; k < 9; ++k) pose.R.data()[k] = lanes.R[k][i];
    pose.t = {lanes.t[0][i], lanes.t[1][i], lanes.t[2][i]};
    pose.scale_observable = true;
    ++candidates.count;
  }
}

template <typename Solution>
PoseCandidates<4> toCandidates(const Solution& solution, const SolverOptions& options, ClassicalSystem& classical) {
  PoseCandidates<4> candidates;
  using Status = decltype(solution.status);
  if (solution.status == Status::kInvalid) {
    candidates.status = SolverStatus::kInvalidInput;
  } else if (solution.status == Status::kStill) {
    candidates.poses[candidates.count++] = standingStill();
  } else if (solution.status == Status::kSingular && classical.vanishes()) {
    candidates.status = SolverStatus::kCentral;
  } else {
    addPoses(solution, options, classical, candidates);
  }
  return candidates;
}

}  // namespace

PoseCandidates<4> solveFourPointLiu(const std::array<RayCorrespondence, 4>& sample, const VerticalPrior& prior,
                                    const SolverOptions& options) {
  PoseCandidates<4> candidates;
  if (!isRotation(prior.R_aligned_body1) || !isRotation(prior.R_aligned_body2) || !centersCover(sample, options)) {
    candidates.status = SolverStatus::kInvalidInput;
    return candidates;
  }
  const bool same_tilt = sameTilt(prior);
  const Eigen::Matrix3d& R2 = prior.R_aligned_body2;
  const VerticalPrior turned = {same_tilt ? R2 : leastTurned(prior), R2};
  const Eigen::Matrix3d& R1 = turned.R_aligned_body1;
  // R = cosθ P + sinθ Q + W
  Eigen::Matrix3d pqw[3];
  pqw[0] = R2.row(0).transpose() * R1.row(0) + R2.row(1).transpose() * R1.row(1);
  pqw[1] = R2.row(1).transpose() * R1.row(0) - R2.row(0).transpose() * R1.row(1);
  pqw[2] = R2.row(2).transpose() * R1.row(2);

  ClassicalSystem classical(sample, turned, options);
  const RayCorrespondence* const rays[4] = {&sample[0], &sample[1], &sample[2], &sample[3]};
#if MULTICAM_EGOMOTION_DISPATCH_AVX2
  if (processorHasAvx2()) {
    avx2_instructions::LinearSolution solution;
    avx2_instructions::solveLinear(rays, R1.data(), R2.data(), pqw[0].data(), same_tilt, solution);
    candidates = toCandidates(solution, options, classical);
  } else
#endif
  {
    build_instructions::LinearSolution solution;
    build_instructions::solveLinear(rays, R1.data(), R2.data(), pqw[0].data(), same_tilt, solution);
    candidates = toCandidates(solution, options, classical);
  }
  if (onePair(sample) && candidates.status == SolverStatus::kOk) {
    candidates.count = 0;
    candidates.status = SolverStatus::kCentral;
  }
  return candidates;
}

}  // namespace multicam_egomotion
