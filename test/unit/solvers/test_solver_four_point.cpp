// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <iostream>
#include <limits>
#include <vector>

#include "multicam_egomotion/solvers/four_point_axis.h"
#include "multicam_egomotion/solvers/four_point_kernel.h"
#include "multicam_egomotion/solvers/four_point_vertical.h"
#include "solver_samples.h"
#include "solver_trials.h"

namespace multicam_egomotion {
namespace {

using Vector3l = Eigen::Matrix<long double, 3, 1>;
using Matrix3l = Eigen::Matrix<long double, 3, 3>;
constexpr double kDegree = M_PI / 180;
constexpr SampleKind kKinds[] = {SampleKind::kIntra22, SampleKind::kIntra31, SampleKind::kIntra211,
                                 SampleKind::kIntra1111, SampleKind::kCross};
constexpr Motion kMotions[] = {Motion::kRandom, Motion::kForward, Motion::kSideways};

enum class Solver { kVertical, kAxis };

PoseCandidates<6> solve(Solver solver, const SimulatedSample& s, const SolverOptions& options = {}) {
  return solver == Solver::kVertical ? solveFourPointVertical(s.rays, s.vertical, options)
                                     : solveFourPointAxis(s.rays, s.axis, options);
}

const RelativePose* nearest(const PoseCandidates<6>& poses, const Eigen::Matrix3d& R) {
  return std::min_element(poses.begin(), poses.end(), [&](const RelativePose& a, const RelativePose& b) {
    return rotationError(a.R, R) < rotationError(b.R, R);
  });
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

ZAlignedFrames frames(Solver solver, const SimulatedSample& s) {
  if (solver == Solver::kVertical) return {s.vertical.R_aligned_body1, s.vertical.R_aligned_body2, false};
  return {rotationToZ(s.axis.axis), rotationToZ(s.axis.axis), true};
}

/// det of the 4x4 system in [t; 1] at the rotation angle θ: the classical
/// formulation, independent of the depths.
long double determinant4(const SimulatedSample& s, const ZAlignedFrames& aligned, long double theta) {
  Matrix3l Rz;
  Rz << std::cos(theta), -std::sin(theta), 0, std::sin(theta), std::cos(theta), 0, 0, 0, 1;
  const Matrix3l R1 = aligned.R_aligned_body1.cast<long double>(), R2 = aligned.R_aligned_body2.cast<long double>();
  const Matrix3l R = R2.transpose() * Rz * R1;
  Eigen::Matrix<long double, 4, 4> rows;
  for (int i = 0; i < 4; ++i) {
    const Vector3l x1 = R * s.rays[i].first.direction.cast<long double>();
    const Vector3l q1 = R * s.rays[i].first.moment.cast<long double>();
    const Vector3l x2 = s.rays[i].second.direction.cast<long double>();
    rows.row(i).head<3>() = x1.cross(x2);
    rows(i, 3) = x1.dot(s.rays[i].second.moment.cast<long double>()) + x2.dot(q1);
  }
  return rows.determinant();
}

double angleOf(const ZAlignedFrames& aligned, const Eigen::Matrix3d& R) {
  const Eigen::Matrix3d Rz = aligned.R_aligned_body2 * R * aligned.R_aligned_body1.transpose();
  return std::atan2(Rz(1, 0) - Rz(0, 1), Rz(0, 0) + Rz(1, 1));
}

TEST(FourPoint, ReturnsTheRootsOfTheClassicalDeterminant) {
  constexpr int kSamples = 4000;
  for (Solver solver : {Solver::kVertical, Solver::kAxis}) {
    for (SampleKind kind : kKinds) {
      SampleSimulator simulator(4);
      for (int trial = 0; trial < 25; ++trial) {
        const SimulatedSample s = simulator.sample(kind, kMotions[trial % 3], 0, 60 * kDegree);
        const ZAlignedFrames aligned = frames(solver, s);
        std::vector<double> found;
        for (const RelativePose& pose : solve(solver, s)) {
          EXPECT_LE(residual(s, pose), 1e-11);
          EXPECT_NEAR((pose.R.transpose() * pose.R - Eigen::Matrix3d::Identity()).norm(), 0, 1e-14);
          found.push_back(angleOf(aligned, pose.R));
        }
        // Sign changes on a dense grid, bisected.
        std::vector<double> expected;
        long double left = -M_PIl + 1e-4L, at_left = determinant4(s, aligned, left);
        for (int i = 1; i <= kSamples; ++i) {
          const long double right = -M_PIl + 1e-4L + 2 * M_PIl * i / kSamples;
          const long double at_right = determinant4(s, aligned, right);
          if ((at_left < 0) != (at_right < 0)) {
            long double lo = left, hi = right;
            for (int k = 0; k < 60; ++k) {
              const long double mid = (lo + hi) / 2;
              ((determinant4(s, aligned, mid) < 0) == (at_left < 0) ? lo : hi) = mid;
            }
            expected.push_back(static_cast<double>(lo));
          }
          left = right;
          at_left = at_right;
        }
        const auto has = [](const std::vector<double>& set, double angle, double tolerance) {
          return std::any_of(set.begin(), set.end(),
                             [&](double a) { return std::abs(std::remainder(a - angle, 2 * M_PI)) < tolerance; });
        };
        int left_out = 0;
        for (double angle : expected) left_out += !has(found, angle, 1e-8);
        // R = I for intra-camera samples of the axis solver; the three rays'
        // centre for 3+1.
        const bool identity = solver == Solver::kAxis && kind != SampleKind::kCross;
        EXPECT_EQ(left_out, kind == SampleKind::kIntra31 ? (identity ? 2 : left_out & 2)
                            : identity                   ? 1
                                                         : 0)
            << "solver " << static_cast<int>(solver) << " kind " << static_cast<int>(kind) << " trial " << trial;
        for (size_t i = 0; i < found.size(); ++i) {
          EXPECT_LE(std::abs(determinant4(s, aligned, found[i])), 1e-14);
          const std::vector<double> others(found.begin() + i + 1, found.end());
          EXPECT_FALSE(has(others, found[i], 1e-12)) << "twice";
        }
      }
    }
  }
}

TEST(FourPoint, DepthDeterminantIsTheClassicalOne) {
  SampleSimulator simulator(5);
  for (int trial = 0; trial < 200; ++trial) {
    const SimulatedSample s = simulator.sample(kKinds[trial % 5], Motion::kRandom, 0, 60 * kDegree);
    const ZAlignedFrames aligned = frames(Solver::kVertical, s);
    const std::array<double, 7> a = fourPointPolynomial(s.rays, aligned);
    double size = 0, sign = 0;
    for (double coefficient : a) size = std::max(size, std::abs(coefficient));
    for (int k = 0; k < 9; ++k) {
      const double tangent = -2 + 0.5 * k;
      double det3 = 0;
      for (int i = 6; i >= 0; --i) det3 = det3 * tangent + a[i];
      // Entries of the paper's F carry a factor 1 + s² each: det4 = ±(1 + s²)
      // det3.
      const double det4 =
          static_cast<double>(determinant4(s, aligned, 2 * std::atan(static_cast<long double>(tangent))));
      const double expected = det3 / std::pow(1 + tangent * tangent, 3);
      if (sign == 0) sign = det4 * expected < 0 ? -1 : 1;
      EXPECT_NEAR(det4, sign * expected, 1e-13 * size);
    }
  }
}

TEST(FourPoint, HalfATurnOfTheFrameIsMinusTheReciprocal) {
  // s = tan(θ / 2) becomes -1 / s, the paper's ω̃ but for the sign: the
  // coefficients in reverse, every other negated.
  SampleSimulator simulator(16);
  for (int trial = 0; trial < 200; ++trial) {
    const SimulatedSample s = simulator.sample(kKinds[trial % 5], Motion::kRandom, 0, 60 * kDegree);
    ZAlignedFrames aligned = frames(Solver::kVertical, s);
    const std::array<double, 7> a = fourPointPolynomial(s.rays, aligned);
    aligned.R_aligned_body1.topRows<2>() *= -1;
    const std::array<double, 7> b = fourPointPolynomial(s.rays, aligned);
    for (int k = 0; k < 7; ++k) EXPECT_NEAR(b[k], (k % 2 ? -1 : 1) * a[6 - k], 1e-14);
  }
}

TEST(FourPoint, TranslationIsThatOfTheSingularVector) {
  SampleSimulator simulator(17);
  int compared = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    const SampleKind kind = trial % 2 ? SampleKind::kIntra22 : SampleKind::kCross;
    const SimulatedSample s = simulator.sample(kind, kMotions[trial % 3], kDegree, 10 * kDegree);
    const Ray &o1 = s.rays[0].first, &o2 = s.rays[0].second;
    const Eigen::Vector3d p1 = o1.direction.cross(o1.moment), p2 = o2.direction.cross(o2.moment);
    for (const RelativePose& pose : solveFourPointVertical(s.rays, s.vertical)) {
      Eigen::Matrix3d F;
      for (int i = 0; i < 3; ++i) {
        const Ray &a = s.rays[i + 1].first, &b = s.rays[i + 1].second;
        const Eigen::Vector3d normal = (pose.R * a.direction).cross(b.direction);
        F.row(i) << -normal.dot(pose.R * o1.direction), normal.dot(o2.direction),
            normal.dot(p2 - pose.R * p1) + (pose.R * a.direction).dot(b.moment) + b.direction.dot(pose.R * a.moment);
      }
      const Eigen::JacobiSVD<Eigen::Matrix3d> svd(F, Eigen::ComputeFullV);
      const Eigen::Vector3d sigma = svd.singularValues(), null = svd.matrixV().col(2);
      if (sigma(1) < 1e-3 * sigma(0) || std::abs(null(2)) < 1e-3) continue;
      const Eigen::Vector3d t =
          p2 + null(1) / null(2) * o2.direction - pose.R * (p1 + null(0) / null(2) * o1.direction);
      EXPECT_LE((t - pose.t).norm(), 1e-8 * (1 + t.norm()));
      ++compared;
    }
  }
  EXPECT_GT(compared, 1000);
}

TEST(FourPoint, ManySamplesAtOnceGiveWhatEachGivesAlone) {
  SampleSimulator simulator(18);
  SimulatedSample s = simulator.sample(SampleKind::kIntra22, Motion::kRandom, 0, 10 * kDegree);
  const VerticalPrior vertical = s.vertical;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (int count : {0, 1, 7, 8, 9, 29}) {
    std::vector<std::array<RayCorrespondence, 4>> samples(count);
    for (int i = 0; i < count; ++i) {
      simulator.observe(i % 6 == 5 ? SampleKind::kOnePair : kKinds[i % 5], s);
      samples[i] = s.rays;
      if (i % 11 == 3) samples[i][2].first.direction.x() = nan;
    }
    SolverOptions options;
    options.positive_depths_only = count % 2 == 0;
    std::vector<PoseCandidates<6>> by_vertical(count), by_axis(count);
    for (PoseCandidates<6>& candidates : by_vertical) candidates.count = 3;  // left from an earlier use
    solveFourPointVertical(samples.data(), count, vertical, options, by_vertical.data());
    solveFourPointAxis(samples.data(), count, s.axis, options, by_axis.data());
    for (int i = 0; i < count; ++i) {
      const auto expectSame = [](const PoseCandidates<6>& a, const PoseCandidates<6>& b) {
        ASSERT_EQ(a.status, b.status);
        ASSERT_EQ(a.size(), b.size());
        for (int k = 0; k < a.size(); ++k) {
          EXPECT_EQ(a[k].R, b[k].R);
          EXPECT_EQ(a[k].t, b[k].t);
          EXPECT_EQ(a[k].scale_observable, b[k].scale_observable);
        }
      };
      expectSame(by_vertical[i], solveFourPointVertical(samples[i], vertical, options));
      expectSame(by_axis[i], solveFourPointAxis(samples[i], s.axis, options));
    }
  }
}

TEST(FourPoint, DepthConstraintIsTheGeneralizedEpipolarConstraint) {
  SampleSimulator simulator(6);
  for (int trial = 0; trial < 100; ++trial) {
    const SimulatedSample s = simulator.sample(SampleKind::kCross, Motion::kRandom, 0, M_PI);
    const Ray &x1 = s.rays[0].first, &x2 = s.rays[0].second, &xi = s.rays[1].first, &xj = s.rays[1].second;
    const double l1 = simulator.uniform(1, 9), l2 = simulator.uniform(1, 9);
    const Eigen::Vector3d t1 = x1.direction.cross(x1.moment) + l1 * x1.direction;
    const Eigen::Vector3d t2 = x2.direction.cross(x2.moment) + l2 * x2.direction;
    const Eigen::Vector3d t = t2 - s.R * t1, Rx = s.R * xi.direction;
    const double b2 = Rx.dot(xj.moment) + xj.direction.dot(s.R * xi.moment) + xj.direction.dot(t.cross(Rx));
    const double b4 = -l1 * xj.direction.dot(s.R * x1.direction.cross(xi.direction)) +
                      l2 * xj.direction.dot(x2.direction.cross(Rx)) + xj.direction.dot(s.R * xi.moment) +
                      Rx.dot(xj.moment) + xj.direction.dot(x2.direction.cross(x2.moment).cross(Rx)) -
                      xj.direction.dot(s.R * x1.direction.cross(x1.moment).cross(xi.direction));
    EXPECT_NEAR(b2, b4, 1e-13 * (1 + t.norm()));
  }
}

TEST(FourPoint, PureTranslationGivesDirectionAndNoScale) {
  const int samples = solverTrials(1000);
  SampleSimulator simulator(7);
  int right = 0, trials = 0;
  for (Solver solver : {Solver::kVertical, Solver::kAxis}) {
    for (SampleKind kind :
         {SampleKind::kIntra22, SampleKind::kIntra31, SampleKind::kIntra211, SampleKind::kIntra1111}) {
      for (int i = 0; i < samples; ++i, ++trials) {
        const SimulatedSample s = simulator.sample(kind, kMotions[i % 3], 0, 0);
        const PoseCandidates<6> poses = solve(solver, s);
        ASSERT_GT(poses.size(), 0);
        const RelativePose* best = nearest(poses, s.R);
        EXPECT_FALSE(best->scale_observable);
        EXPECT_NEAR(best->t.norm(), 1, 1e-12);
        right += rotationError(best->R, s.R) < 1e-8 && directionError(best->t, s.t) < 1e-6;
      }
    }
  }
  std::cout << right << " of " << trials << " right\n";
  EXPECT_GE(right, trials * 0.999);
}

TEST(FourPoint, ScaleIsObservableInRotationAndAcrossCameras) {
  const int samples = solverTrials(5000);
  SampleSimulator simulator(8);
  int flagged = 0, trials = 0;
  for (Solver solver : {Solver::kVertical, Solver::kAxis}) {
    for (int i = 0; i < samples; ++i) {
      const SimulatedSample s = simulator.sample(kKinds[i % 5], kMotions[i % 3], kDegree, 20 * kDegree);
      const SimulatedSample cross = simulator.sample(SampleKind::kCross, kMotions[i % 3], 0, 0);
      for (const SimulatedSample& sample : {s, cross}) {
        flagged += !nearest(solve(solver, sample), sample.R)->scale_observable;
        ++trials;
      }
    }
  }
  std::cout << flagged << " of " << trials << " flagged\n";
  EXPECT_LE(flagged, trials * 0.001);
}

TEST(FourPoint, StandingStillIsIdentityWithoutScale) {
  SampleSimulator simulator(9);
  for (int i = 0; i < 200; ++i) {
    SimulatedSample s = simulator.sample(SampleKind::kIntra22, Motion::kRandom, 0, 0);
    s.t.setZero();
    simulator.observe(SampleKind::kIntra22, s);
    for (Solver solver : {Solver::kVertical, Solver::kAxis}) {
      const PoseCandidates<6> poses = solve(solver, s);
      for (const RelativePose& pose : poses) EXPECT_TRUE(pose.R.allFinite() && pose.t.allFinite());
      ASSERT_FALSE(poses.empty());
      const RelativePose* best = nearest(poses, s.R);
      EXPECT_LT(rotationError(best->R, s.R), 1e-6);
      EXPECT_FALSE(best->scale_observable);
    }
  }
}

TEST(FourPoint, PositiveDepthsKeepTheTruthAndDropOthers) {
  SampleSimulator simulator(10);
  int all = 0, kept = 0;
  for (int i = 0; i < 2000; ++i) {
    const SimulatedSample s = simulator.sample(kKinds[i % 5], kMotions[i % 3], 0.5 * kDegree, 10 * kDegree);
    SolverOptions options;
    options.positive_depths_only = true;
    options.camera_centers = s.centers.data();
    options.camera_count = 4;
    for (Solver solver : {Solver::kVertical, Solver::kAxis}) {
      all += solve(solver, s).size();
      const PoseCandidates<6> poses = solve(solver, s, options);
      kept += poses.size();
      ASSERT_FALSE(poses.empty());
      EXPECT_LT(rotationError(nearest(poses, s.R)->R, s.R), 1e-6);
    }
  }
  EXPECT_LT(kept, 0.7 * all);
}

TEST(FourPoint, OnePairIsCentral) {
  SampleSimulator simulator(11);
  const SimulatedSample s = simulator.sample(SampleKind::kOnePair, Motion::kRandom, 0, 1);
  for (Solver solver : {Solver::kVertical, Solver::kAxis}) {
    EXPECT_EQ(solve(solver, s).status, SolverStatus::kCentral);
    EXPECT_TRUE(solve(solver, s).empty());
    // Two cameras in one place.
    SimulatedSample coincident = s;
    for (int i = 0; i < 4; ++i) coincident.rays[i].camera1 = coincident.rays[i].camera2 = i % 2;
    EXPECT_EQ(solve(solver, coincident).status, SolverStatus::kCentral);
  }
}

TEST(FourPoint, RepeatedRaysAreCentral) {
  SampleSimulator simulator(15);
  for (int i = 0; i < 5000; ++i) {
    SimulatedSample s = simulator.sample(kKinds[i % 5], Motion::kRandom, 0, 1);
    s.rays[1] = s.rays[0];
    for (Solver solver : {Solver::kVertical, Solver::kAxis}) {
      EXPECT_EQ(solve(solver, s).status, SolverStatus::kCentral) << i;
    }
  }
}

TEST(FourPoint, AxisLengthAndSignDoNotMatter) {
  SampleSimulator simulator(12);
  SimulatedSample s = simulator.sample(SampleKind::kIntra22, Motion::kRandom, 0.1, 0.2);
  s.axis.axis *= -17;
  EXPECT_LT(rotationError(nearest(solve(Solver::kAxis, s), s.R)->R, s.R), 1e-9);
  s.axis.axis.setZero();
  EXPECT_EQ(solve(Solver::kAxis, s).status, SolverStatus::kAxisUndefined);
}

TEST(FourPoint, BadInputIsAStatusNeverANaN) {
  SampleSimulator simulator(13);
  const double bad[] = {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), 0, 1e200};
  for (int i = 0; i < 20000; ++i) {
    SimulatedSample s = simulator.sample(kKinds[i % 5], Motion::kRandom, 0, 1);
    double* values = s.rays[static_cast<int>(simulator.uniform(0, 3.999))].first.direction.data();
    const double value = bad[i % 4];
    if (i % 3 == 0) {
      for (int k = 0; k < 3; ++k) values[k] = value;
    } else if (i % 3 == 1) {
      values[static_cast<int>(simulator.uniform(0, 11.999))] = value;
    } else {
      s.rays[1] = s.rays[0];
      if (value != 0) s.vertical.R_aligned_body1(1, 1) = s.axis.axis.x() = value;
    }
    for (Solver solver : {Solver::kVertical, Solver::kAxis}) {
      const PoseCandidates<6> poses = solve(solver, s);
      if (!std::isfinite(value)) {
        EXPECT_EQ(poses.status, SolverStatus::kInvalidInput);
      }
      if (i % 3 == 0 && value == 0) {
        EXPECT_EQ(poses.status, SolverStatus::kInvalidInput);
      }
      if (poses.status != SolverStatus::kOk) {
        EXPECT_TRUE(poses.empty());
      }
      for (const RelativePose& pose : poses) ASSERT_TRUE(pose.R.allFinite() && pose.t.allFinite()) << i;
    }
  }
}

TEST(FourPoint, CentersMustCoverTheCameras) {
  SampleSimulator simulator(14);
  const SimulatedSample s = simulator.sample(SampleKind::kIntra22, Motion::kRandom, 0, 1);
  SolverOptions options;
  options.camera_centers = s.centers.data();
  options.camera_count = 1;
  EXPECT_EQ(solve(Solver::kVertical, s, options).status, SolverStatus::kInvalidInput);
}

}  // namespace
}  // namespace multicam_egomotion
