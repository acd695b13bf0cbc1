// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
//
// 4pt-vertical and 4pt-axis against the true motion and against a reference in extended precision.
// MULTICAM_EGOMOTION_SOLVER_TRIALS: samples per motion (1000000 for the figures of the documentation) or, beside the
// reference, per class (100000).
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iostream>
#include <limits>
#include <random>
#include <vector>

#include "classical_reference.h"
#include "multicam_egomotion/solvers/four_point_axis.h"
#include "multicam_egomotion/solvers/four_point_vertical.h"
#include "solver_samples.h"
#include "solver_trials.h"

namespace multicam_egomotion {
namespace {

constexpr double kDegree = M_PI / 180;
constexpr SampleKind kKinds[] = {SampleKind::kIntra22, SampleKind::kIntra31, SampleKind::kIntra211,
                                 SampleKind::kIntra1111, SampleKind::kCross};
constexpr Motion kMotions[] = {Motion::kRandom, Motion::kForward, Motion::kSideways};
constexpr double kRanges[][2] = {{0, 0.3}, {0, 10}, {0, 60}, {179, 180}, {180, 180}};

enum class Solver { kVertical, kAxis };
constexpr Solver kSolvers[] = {Solver::kVertical, Solver::kAxis};

PoseCandidates<6> solve(Solver solver, const SimulatedSample& s) {
  return solver == Solver::kVertical ? solveFourPointVertical(s.rays, s.vertical) : solveFourPointAxis(s.rays, s.axis);
}

struct Errors {
  std::vector<double> rotation;
  int failures = 0;

  double quantile(double q) {
    const auto at = rotation.begin() + static_cast<int>(q * (rotation.size() - 1));
    std::nth_element(rotation.begin(), at, rotation.end());
    return *at;
  }
};

/// Error of the solution nearest the truth; a failure is printed with the
/// distance to the next solution.
void add(const SimulatedSample& s, const PoseCandidates<6>& poses, Errors& errors) {
  std::vector<double> distances = {M_PI, M_PI};
  for (const RelativePose& pose : poses) distances.push_back(rotationError(pose.R, s.R));
  std::sort(distances.begin(), distances.end());
  errors.rotation.push_back(distances[0]);
  if (distances[0] <= 1e-6) return;
  ++errors.failures;
  std::cout << "failure: error " << distances[0] << " rad, next solution at " << distances[1] << " rad, of "
            << poses.size() << " solutions\n";
}

TEST(FourPointAccuracy, SmallRotationsOfEveryMotion) {
  const int trials = solverTrials(20000);
  for (Solver solver : kSolvers) {
    for (Motion motion : kMotions) {
      SampleSimulator simulator(31 + static_cast<unsigned>(motion));
      Errors errors;
      for (int i = 0; i < trials; ++i) {
        const SimulatedSample s = simulator.sample(kKinds[i % 5], motion, 0, 10 * kDegree);
        add(s, solve(solver, s), errors);
      }
      std::cout << "solver " << static_cast<int>(solver) << " motion " << static_cast<int>(motion) << ": 10^"
                << std::log10(errors.quantile(0.5)) << " median, 10^" << std::log10(errors.quantile(0.999))
                << " p99.9, 10^" << std::log10(errors.quantile(1)) << " largest, " << errors.failures << " failures of "
                << trials << "\n";
      EXPECT_LE(errors.quantile(0.5), std::pow(10, -14.5));
      EXPECT_LE(errors.quantile(0.999), std::pow(10, -11.5));
      EXPECT_LE(errors.failures, 3e-6 * trials);
    }
  }
}

TEST(FourPointAccuracy, AnyRotation) {
  const int trials = std::max(1, solverTrials(15000) / 15);
  for (Solver solver : kSolvers) {
    for (const auto& range : kRanges) {
      Errors errors;
      for (SampleKind kind : kKinds) {
        SampleSimulator simulator(3);
        for (int i = 0; i < 3 * trials; ++i) {
          const SimulatedSample s = simulator.sample(kind, kMotions[i % 3], range[0] * kDegree, range[1] * kDegree);
          add(s, solve(solver, s), errors);
        }
      }
      SCOPED_TRACE(testing::Message() << "solver " << static_cast<int>(solver) << " up to " << range[1] << " deg");
      EXPECT_LE(errors.quantile(0.5), std::pow(10, -14.5));
      // At rotations near zero the vertical solver has its second root, R = I
      // of nearly equal tilt, close by.
      EXPECT_LE(errors.quantile(0.999), std::pow(10, range[1] < 1 ? -10.5 : -11.2));
      EXPECT_LE(errors.failures, 1e-5 * errors.rotation.size());
    }
  }
}

/// Largest residual of the generalized epipolar constraint (b2), relative to
/// the size of rig and translation.
double residual(const SimulatedSample& s, const RelativePose& pose) {
  double largest = 0;
  for (const RayCorrespondence& ray : s.rays) {
    const Eigen::Vector3d x = pose.R * ray.first.direction, q = pose.R * ray.first.moment + pose.t.cross(x);
    largest = std::max(largest, std::abs(x.dot(ray.second.moment) + ray.second.direction.dot(q)));
  }
  return largest / (1 + pose.t.norm());
}

/// How far a root moves, at most, when the sample is rounded differently: how well the input determines it [rad].
double conditioning(const SimulatedSample& s, double angle, bool three_and_one, bool identity) {
  constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
  std::mt19937 random(1);
  const auto nudge = [&](Eigen::Vector3d& v) {
    for (double& x : v) x *= 1 + (random() & 1 ? kEpsilon : -kEpsilon);
  };
  double largest = 0;
  for (int trial = 0; trial < 4; ++trial) {
    std::array<RayCorrespondence, 4> rays = s.rays;
    for (RayCorrespondence& ray : rays) {
      nudge(ray.first.moment);
      nudge(ray.second.moment);
    }
    const ReferenceAngles other = referenceAngles(rays, s.vertical, three_and_one, identity);
    largest = std::max(largest, distanceToNearest(other.angles, angle));
  }
  return largest;
}

TEST(FourPointAccuracy, ReturnsTheSetOfTheReference) {
  const int trials = std::max(1, solverTrials(1000) / 5);
  int undecided = 0, ill_conditioned = 0, samples = 0;
  double largest_residual = 0;
  for (Solver solver : kSolvers) {
    for (const auto& range : kRanges) {
      for (SampleKind kind : kKinds) {
        SampleSimulator simulator(4);
        for (int i = 0; i < trials; ++i) {
          SimulatedSample s = simulator.sample(kind, kMotions[i % 3], range[0] * kDegree, range[1] * kDegree);
          // Every other sample turns about its vertical: the tilt is the same
          // in both frames.
          const bool same_tilt = i % 2 == 1 || solver == Solver::kAxis;
          if (same_tilt) s.vertical = verticalPriorFromUp(s.axis.axis, s.axis.axis);
          const bool three_and_one = kind == SampleKind::kIntra31;
          const bool identity = same_tilt && kind != SampleKind::kCross;
          const ReferenceAngles reference = referenceAngles(s.rays, s.vertical, three_and_one, identity);
          const PoseCandidates<6> poses = solve(solver, s);
          SCOPED_TRACE(testing::Message() << "solver " << static_cast<int>(solver) << " up to " << range[1]
                                          << " deg, kind " << static_cast<int>(kind) << " trial " << i);
          ASSERT_EQ(poses.status, SolverStatus::kOk);
          std::vector<double> found;
          for (const RelativePose& pose : poses) {
            if (pose.scale_observable) {
              largest_residual = std::max(largest_residual, residual(s, pose));
              EXPECT_LE(residual(s, pose), 1e-12);
            }
            EXPECT_LE((pose.R.transpose() * pose.R - Eigen::Matrix3d::Identity()).norm(), 1e-14);
            const double angle = yawBetween(s.vertical, pose.R);
            EXPECT_GT(distanceToNearest(found, angle), 1e-9) << "twice";
            found.push_back(angle);
          }
          ++samples;
          if (!reference.decided) {
            ++undecided;
            continue;
          }
          ASSERT_EQ(found.size(), reference.angles.size());
          for (double angle : reference.angles) {
            const double error = distanceToNearest(found, angle);
            if (error <= 1e-9) continue;
            EXPECT_LE(error, 10 * conditioning(s, angle, three_and_one, identity));
            ++ill_conditioned;
          }
        }
      }
    }
  }
  std::cout << samples << " samples, " << undecided << " undecided, " << ill_conditioned
            << " with an ill-conditioned root, largest residual " << largest_residual << "\n";
  EXPECT_LE(undecided, samples / 100);
  EXPECT_LE(ill_conditioned, samples / 100);
}

}  // namespace
}  // namespace multicam_egomotion
