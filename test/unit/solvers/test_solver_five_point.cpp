// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
//
// 5pt-martyushev against the truth of simulated samples and against a dense search over the axes.
// MULTICAM_EGOMOTION_SOLVER_TRIALS: samples per kind and largest angle of the accuracy test (100000 for the figures of
// the documentation).
#include <gtest/gtest.h>

#include <Eigen/SVD>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>
#include <vector>

#include "five_point_samples.h"
#include "multicam_egomotion/solvers/five_point_martyushev.h"
#include "solver_trials.h"

namespace multicam_egomotion {
namespace {

constexpr double kDegree = M_PI / 180;
constexpr CameraPairs kIntra41 = {{{0, 0}, {0, 0}, {1, 1}, {0, 0}, {0, 0}}};
constexpr int kKinds = 6;

const CameraPairs& pairsOf(int i) { return kFivePointKinds[i % kKinds].pairs; }
Motion motionOf(int i) { return static_cast<Motion>(i % 3); }

const RelativePose* nearest(const PoseCandidates<44>& poses, const Eigen::Matrix3d& R) {
  return std::min_element(poses.begin(), poses.end(), [&](const RelativePose& a, const RelativePose& b) {
    return rotationError(a.R, R) < rotationError(b.R, R);
  });
}

/// Largest residual of the generalized epipolar constraint, relative to the size of rig and translation.
double residual(const FivePointSample& p, const RelativePose& pose) {
  double largest = 0;
  for (const RayCorrespondence& ray : p.rays) {
    const Eigen::Vector3d x = pose.R * ray.first.direction, q = pose.R * ray.first.moment + pose.t.cross(x);
    largest = std::max(largest, std::abs(x.dot(ray.second.moment) + ray.second.direction.dot(q)));
  }
  return largest / (1 + pose.t.norm());
}

class FivePointMartyushevTruth : public testing::TestWithParam<FivePointKind> {};

TEST_P(FivePointMartyushevTruth, IsFoundToRounding) {
  const int trials = solverTrials(100);
  const FivePointKind& kind = GetParam();
  for (double largest : {0.003, 0.3, 10.0, 60.0, 180.0}) {
    SampleSimulator simulator(1);
    std::vector<double> errors, translation_errors;
    int failures = 0;
    for (int i = 0; i < trials; ++i) {
      const FivePointSample p = fivePointSample(simulator, kind.pairs, motionOf(i), 0, largest * kDegree);
      const PoseCandidates<44> poses = solveFivePointMartyushev(p.rays, p.prior);
      ASSERT_EQ(poses.status, SolverStatus::kOk);
      double error = M_PI;
      if (!poses.empty()) {
        const RelativePose* best = nearest(poses, p.R);
        error = rotationError(best->R, p.R);
        translation_errors.push_back((best->t - p.t).norm());
      }
      errors.push_back(error);
      // At small angles the rotation is right only if the axis is.
      failures += error > 1e-6 || error > 0.01 * p.prior.angle;
    }
    std::sort(errors.begin(), errors.end());
    std::sort(translation_errors.begin(), translation_errors.end());
    const double median = errors[trials / 2];
    std::printf("%-14s <= %g deg: %d failures of %d, median error %.1e rad\n", kind.name, largest, failures, trials,
                median);
    std::fflush(stdout);
    SCOPED_TRACE(testing::Message() << kind.name << " up to " << largest << " deg");
    EXPECT_LE(failures, 0.003 * trials + 1);
    EXPECT_LE(median, 1e-14);
    ASSERT_FALSE(translation_errors.empty());
    EXPECT_LE(translation_errors[translation_errors.size() / 2], 1e-8);
  }
}

INSTANTIATE_TEST_SUITE_P(FivePointMartyushev, FivePointMartyushevTruth, testing::ValuesIn(kFivePointKinds),
                         [](const auto& info) {
                           std::string name = info.param.name;
                           name.erase(std::remove(name.begin(), name.end(), '_'), name.end());
                           return name;
                         });

TEST(FivePointMartyushev, EverySolutionFitsAndNoneIsTwice) {
  int solutions = 0;
  for (double largest : {0.3, 10.0, 60.0, 180.0}) {
    for (const FivePointKind& kind : kFivePointKinds) {
      SampleSimulator simulator(2);
      for (int i = 0; i < 20; ++i) {
        const FivePointSample p = fivePointSample(simulator, kind.pairs, motionOf(i), 0, largest * kDegree);
        const PoseCandidates<44> poses = solveFivePointMartyushev(p.rays, p.prior);
        for (const RelativePose& pose : poses) {
          ++solutions;
          EXPECT_LE(residual(p, pose), 1e-12);
          EXPECT_LE((pose.R.transpose() * pose.R - Eigen::Matrix3d::Identity()).norm(), 1e-14);
          EXPECT_NEAR(rotationError(pose.R, Eigen::Matrix3d::Identity()), p.prior.angle, 1e-14 + 1e-8 * p.prior.angle);
          for (const RelativePose& other : poses) {
            if (&other != &pose) {
              EXPECT_GT((other.R - pose.R).norm(), 1e-9 * p.prior.angle);
            }
          }
        }
      }
    }
  }
  EXPECT_GT(solutions, 4 * kKinds * 20 * 3);
}

using Matrix54 = Eigen::Matrix<double, 5, 4>;

Matrix54 constraints(const FivePointSample& p, const Eigen::Vector3d& n) {
  const Eigen::Matrix3d R = Eigen::AngleAxisd(p.prior.angle, n.normalized()).toRotationMatrix();
  Matrix54 m;
  for (int i = 0; i < 5; ++i) {
    const Eigen::Vector3d x = R * p.rays[i].first.direction, &x2 = p.rays[i].second.direction;
    m.row(i) << x.cross(x2).transpose(), x.dot(p.rays[i].second.moment) + x2.dot(R * p.rays[i].first.moment);
  }
  return m;
}

using Svd54 = Eigen::JacobiSVD<Matrix54, Eigen::FullPivHouseholderQRPreconditioner>;

/// Newton's method for an axis at which the constraints have rank 3, from the singular vectors. False if it does not
/// converge.
bool toLossOfRank(const FivePointSample& p, Eigen::Vector3d& n) {
  constexpr double kDifference = 1e-6;
  double size = 1;
  for (int iteration = 0; iteration < 25; ++iteration) {
    const Svd54 svd(constraints(p, n), Eigen::ComputeFullU | Eigen::ComputeFullV);
    if (size < 1e-10) return svd.singularValues()(3) < 1e-12 * svd.singularValues()(0);
    const Eigen::Matrix<double, 5, 2> out = svd.matrixU().rightCols<2>();
    const Eigen::Vector4d v = svd.matrixV().col(3);
    const Eigen::Vector3d e[2] = {n.unitOrthogonal(), n.cross(n.unitOrthogonal())};
    Eigen::Matrix2d jacobian;
    for (int k = 0; k < 2; ++k) {
      const Eigen::Vector3d d = kDifference * e[k];
      jacobian.col(k) = out.transpose() * (constraints(p, n + d) - constraints(p, n - d)) * v / (2 * kDifference);
    }
    Eigen::Vector2d step = -jacobian.inverse() * (out.transpose() * constraints(p, n) * v);
    size = step.norm();
    if (size > 0.2) step *= 0.2 / size;
    n = (n + step(0) * e[0] + step(1) * e[1]).normalized();
  }
  return false;
}

TEST(FivePointMartyushev, MissesNoSolutionOfADenseSearch) {
  constexpr int kStarts = 150;
  const double ranges[][2] = {{0.05, 0.3}, {0.3, 1}, {1, 3}};
  SampleSimulator simulator(3);
  int expected = 0;
  for (int trial = 0; trial < 3 * kKinds; ++trial) {
    const CameraPairs& pairs = pairsOf(trial);
    const double* range = ranges[trial / kKinds];
    const FivePointSample p = fivePointSample(simulator, pairs, motionOf(trial), range[0], range[1]);
    const PoseCandidates<44> poses = solveFivePointMartyushev(p.rays, p.prior);
    const bool triple = pairs[0] == pairs[2] && pairs[0] == pairs[4];  // may meet in their camera centre
    std::vector<Eigen::Matrix3d> found;
    for (int start = 0; start < kStarts; ++start) {
      const double z = 1 - (2 * start + 1.0) / kStarts, azimuth = 2.399963229728653 * start, r = std::sqrt(1 - z * z);
      Eigen::Vector3d n(r * std::cos(azimuth), r * std::sin(azimuth), z);
      if (!toLossOfRank(p, n)) continue;
      const Eigen::Matrix3d R = Eigen::AngleAxisd(p.prior.angle, n).toRotationMatrix();
      if (std::none_of(found.begin(), found.end(), [&](const auto& f) { return rotationError(f, R) < 1e-7; })) {
        found.push_back(R);
        const Svd54 svd(constraints(p, n), Eigen::ComputeFullV);
        const Eigen::Vector4d v = svd.matrixV().col(3);
        const Eigen::Vector3d t = v.head<3>() / v(3);
        const bool in_center =
            triple && (R * p.centers[pairs[0][0]] + t - p.centers[pairs[0][1]]).norm() < 1e-6 * (1 + t.norm());
        if (in_center) continue;
        ++expected;
        const double distance = poses.empty() ? M_PI : rotationError(nearest(poses, R)->R, R);
        EXPECT_LE(distance, 1e-9) << "trial " << trial << ", " << poses.size() << " found, singular values "
                                  << svd.singularValues().transpose();
      }
    }
  }
  EXPECT_GT(expected, 3 * kKinds * 4);
}

TEST(FivePointMartyushev, ThreeRaysOfOnePairDoNotMeetInTheirCamera) {
  SampleSimulator simulator(4);
  for (int i = 0; i < 100; ++i) {
    const CameraPairs& pairs = i % 2 ? kIntra32 : kCross2;
    const FivePointSample p = fivePointSample(simulator, pairs, motionOf(i), 0.1, 1);
    for (const RelativePose& pose : solveFivePointMartyushev(p.rays, p.prior)) {
      EXPECT_GT((pose.R * p.centers[pairs[0][0]] + pose.t - p.centers[pairs[0][1]]).norm(), 1e-7);
    }
  }
}

TEST(FivePointMartyushev, AngleHasNeitherSignNorTurns) {
  SampleSimulator simulator(5);
  for (int i = 0; i < 20; ++i) {
    const FivePointSample p = fivePointSample(simulator, pairsOf(i), Motion::kRandom, 0.1, 3);
    for (double angle : {-p.prior.angle, p.prior.angle + 2 * M_PI, 2 * M_PI - p.prior.angle}) {
      const PoseCandidates<44> poses = solveFivePointMartyushev(p.rays, {angle});
      ASSERT_FALSE(poses.empty());
      EXPECT_LT(rotationError(nearest(poses, p.R)->R, p.R), 1e-7);
    }
  }
}

TEST(FivePointMartyushev, HalfATurnHasEachRotationOnce) {
  SampleSimulator simulator(6);
  for (int i = 0; i < 40; ++i) {
    const FivePointSample p = fivePointSample(simulator, pairsOf(i), Motion::kRandom, M_PI, M_PI);
    const PoseCandidates<44> poses = solveFivePointMartyushev(p.rays, p.prior);
    ASSERT_FALSE(poses.empty());
    EXPECT_LT(rotationError(nearest(poses, p.R)->R, p.R), 1e-7);
    for (const RelativePose& pose : poses) {
      for (const RelativePose& other : poses) {
        if (&other != &pose) {
          EXPECT_GT((other.R - pose.R).norm(), 1e-9);
        }
      }
    }
  }
}

TEST(FivePointMartyushev, NoAngleIsNoAxis) {
  SampleSimulator simulator(7);
  const FivePointSample p = fivePointSample(simulator, kIntra221, Motion::kRandom, 0, 0);
  for (double angle : {0.0, 1e-14, 2 * M_PI}) {
    EXPECT_EQ(solveFivePointMartyushev(p.rays, {angle}).status, SolverStatus::kAxisUndefined);
  }
}

TEST(FivePointMartyushev, ScaleIsObservableInRotationOnly) {
  SampleSimulator simulator(8);
  for (int i = 0; i < 100; ++i) {
    FivePointSample p = fivePointSample(simulator, kIntra221, motionOf(i), kDegree, 10 * kDegree);
    PoseCandidates<44> poses = solveFivePointMartyushev(p.rays, p.prior);
    ASSERT_FALSE(poses.empty());
    EXPECT_TRUE(nearest(poses, p.R)->scale_observable);
    p = fivePointSample(simulator, kIntra221, motionOf(i), 1e-10, 1e-9);
    poses = solveFivePointMartyushev(p.rays, p.prior);
    ASSERT_FALSE(poses.empty());
    const RelativePose* best = nearest(poses, p.R);
    EXPECT_FALSE(best->scale_observable);
    EXPECT_NEAR(best->t.norm(), 1, 1e-12);
    EXPECT_LT(directionError(best->t, p.t), 1e-5);
  }
}

TEST(FivePointMartyushev, PositiveDepthsKeepTheTruthAndDropOthers) {
  SampleSimulator simulator(9);
  int all = 0, kept = 0;
  for (int i = 0; i < 200; ++i) {
    const FivePointSample p = fivePointSample(simulator, pairsOf(i), motionOf(i), kDegree, 30 * kDegree);
    SolverOptions options;
    options.positive_depths_only = true;
    options.camera_centers = p.centers.data();
    options.camera_count = 4;
    all += solveFivePointMartyushev(p.rays, p.prior).size();
    const PoseCandidates<44> poses = solveFivePointMartyushev(p.rays, p.prior, options);
    kept += poses.size();
    ASSERT_FALSE(poses.empty());
    EXPECT_LT(rotationError(nearest(poses, p.R)->R, p.R), 1e-6);
  }
  EXPECT_LT(kept, 0.6 * all);
}

TEST(FivePointMartyushev, OnePairOrCoincidentCentersAreCentral) {
  SampleSimulator simulator(10);
  const CameraPairs one = {{{0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}}};
  for (int i = 0; i < 20; ++i) {
    const double angle = i % 2 ? 0.5 : 1e-3;
    FivePointSample p = fivePointSample(simulator, one, motionOf(i), angle, angle);
    EXPECT_EQ(solveFivePointMartyushev(p.rays, p.prior).status, SolverStatus::kCentral);
    // Cameras in one place.
    for (int k = 0; k < 5; ++k) p.rays[k].camera1 = p.rays[k].camera2 = k;
    EXPECT_EQ(solveFivePointMartyushev(p.rays, p.prior).status, SolverStatus::kCentral);
    // Four of one camera leave the fifth's depth free.
    p = fivePointSample(simulator, kIntra41, motionOf(i), angle, angle);
    EXPECT_EQ(solveFivePointMartyushev(p.rays, p.prior).status, SolverStatus::kCentral);
    for (int k = 0; k < 5; ++k) p.rays[k].camera1 = p.rays[k].camera2 = k;
    EXPECT_EQ(solveFivePointMartyushev(p.rays, p.prior).status, SolverStatus::kCentral);
  }
}

TEST(FivePointMartyushev, RepeatedRaysAreCentral) {
  SampleSimulator simulator(11);
  for (int i = 0; i < 60; ++i) {
    FivePointSample p = fivePointSample(simulator, pairsOf(i), Motion::kRandom, i % 2 ? 0.1 : 1e-4, i % 2 ? 1 : 2e-3);
    p.rays[3] = p.rays[1];
    EXPECT_EQ(solveFivePointMartyushev(p.rays, p.prior).status, SolverStatus::kCentral) << i;
  }
}

TEST(FivePointMartyushev, BadInputIsAStatusNeverANaN) {
  SampleSimulator simulator(12);
  const double bad[] = {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), 0, 1e200,
                        1e-200};
  enum { kVector, kEntry, kAngle, kRepeatedPoint };
  for (int i = 0; i < 800; ++i) {
    FivePointSample p = fivePointSample(simulator, pairsOf(i), Motion::kRandom, 0, i % 2 ? 1 : 1e-3);
    RayCorrespondence& ray = p.rays[static_cast<int>(simulator.uniform(0, 4.999))];
    Eigen::Vector3d* vectors[] = {&ray.first.direction, &ray.first.moment, &ray.second.direction, &ray.second.moment};
    const int which = static_cast<int>(simulator.uniform(0, 3.999));
    Eigen::Vector3d& vector = *vectors[which];
    const double value = bad[i % 5];
    const int fault = i / 5 % 4;
    if (fault == kVector) vector.setConstant(value);
    if (fault == kEntry) vector(static_cast<int>(simulator.uniform(0, 2.999))) = value;
    if (fault == kAngle) p.prior.angle = value;
    if (fault == kRepeatedPoint) {
      ray = p.rays[0];
      ray.first.moment *= 1 + 1e-15;
    }
    const PoseCandidates<44> poses = solveFivePointMartyushev(p.rays, p.prior);
    if (fault != kRepeatedPoint && !std::isfinite(value)) {
      EXPECT_EQ(poses.status, SolverStatus::kInvalidInput) << i;
    }
    const bool direction = which % 2 == 0;
    if (fault == kVector && direction && value < 1) {
      EXPECT_EQ(poses.status, SolverStatus::kInvalidInput) << i;
    }
    if (poses.status != SolverStatus::kOk) {
      EXPECT_TRUE(poses.empty());
    }
    for (const RelativePose& pose : poses) ASSERT_TRUE(pose.R.allFinite() && pose.t.allFinite()) << i;
  }
}

TEST(FivePointMartyushev, CentersMustCoverTheCameras) {
  SampleSimulator simulator(13);
  const FivePointSample p = fivePointSample(simulator, kIntra32, Motion::kRandom, 0.1, 1);
  SolverOptions options;
  options.camera_centers = p.centers.data();
  options.camera_count = 1;
  EXPECT_EQ(solveFivePointMartyushev(p.rays, p.prior, options).status, SolverStatus::kInvalidInput);
}

}  // namespace
}  // namespace multicam_egomotion
