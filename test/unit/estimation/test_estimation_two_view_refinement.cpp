// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "correspondence_scene.h"
#include "multicam_egomotion/estimation/two_view_normal_equations.h"
#include "multicam_egomotion/estimation/two_view_refinement.h"
#include "multicam_egomotion/geometry/covariance.h"

namespace multicam_egomotion {
namespace {

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

constexpr double kMaxError = 2.0;  // [px]

RayBlocks<double> blocksOf(const CorrespondenceSet& set) {
  return set.weightedBlocks(std::vector<double>(set.size(), 1.0));
}

TwoViewEstimate startAt(const Eigen::Matrix3d& R, const Eigen::Vector3d& t) {
  TwoViewEstimate start;
  start.R = R;
  start.t = t;
  return start;
}

double rotationErrorOf(const Eigen::Matrix3d& R, const CorrespondenceScene& scene) {
  return logSO3(R * scene.R.transpose()).norm();
}

// Of the baseline of camera 0, which one camera sees as well as several.
double directionErrorOf(const Eigen::Matrix3d& R, const Eigen::Vector3d& t, const CorrespondenceScene& scene) {
  const Eigen::Vector3d& center = scene.centers[0];
  const Eigen::Vector3d truth = scene.R * center + scene.t - center, found = R * center + t - center;
  return std::acos(std::min(1.0, found.normalized().dot(truth.normalized())));
}

MotionPriors priorsAbout(const Eigen::Matrix3d& R) {
  MotionPriors priors;
  priors.rotation = {expSO3({0.02, 0.01, -0.03}) * R, Eigen::Vector3d(1e4, 2e4, 5e3).asDiagonal()};
  priors.tilt.up_body1 = Eigen::Vector3d(0.1, -0.2, 1.0).normalized();
  priors.tilt.up_body2 = expSO3({0.01, -0.02, 0.0}) * R * priors.tilt.up_body1;
  priors.tilt.information = 3e4;
  priors.angle = {logSO3(R).norm() + 0.01, 1e4};
  return priors;
}

TEST(TwoViewNormalEquations, GradientIsThatOfTheCost) {
  const CorrespondenceScene scene = makeCorrespondenceScene(stereoShape(), kRotation, kTranslation, 150, 0.5, 0.1, 3);
  const CorrespondenceSet set = scene.set();
  const RayBlocks<double> rays = blocksOf(set);
  const Eigen::Matrix3d R = expSO3({0.0008, -0.0005, 0.0006}) * scene.R;
  const Eigen::Vector3d t = scene.t + Eigen::Vector3d(0.004, -0.003, 0.002);
  const TwoViewNoise noise{{0.8, 2.5}, 0.5};
  for (const MotionPriors& priors : {MotionPriors(), priorsAbout(scene.R)}) {
    const auto at = [&](const Vector6d& d) {
      return linearizeTwoView(rays, false, noise, priors, expSO3(d.tail<3>()) * R, t + d.head<3>());
    };
    const TwoViewNormalEquations equations = at(Vector6d::Zero());
    for (int i = 0; i < 6; ++i) {
      const double h = 1e-7;
      const double slope = (at(h * Vector6d::Unit(i)).cost - at(-h * Vector6d::Unit(i)).cost) / (2.0 * h);
      EXPECT_NEAR(equations.g[i], slope, 2e-3 * equations.g.norm()) << i;
    }
    EXPECT_TRUE(isPositiveDefinite(equations.H));
  }
}

TEST(TwoViewNormalEquations, HessianIsThatOfLeastSquaresAndSinglePrecisionAgrees) {
  const CorrespondenceScene scene = makeCorrespondenceScene(surroundShape(), kRotation, kTranslation, 150, 0.0, 0.0, 4);
  const CorrespondenceSet set = scene.set();
  const TwoViewNoise noise{{4.0, 4.0}, 0.5};
  const MotionPriors priors = priorsAbout(scene.R);
  const auto gradientAt = [&](const Vector6d& d) -> Vector6d {
    return linearizeTwoView(blocksOf(set), false, noise, priors, expSO3(d.tail<3>()) * scene.R, scene.t + d.head<3>())
        .g;
  };
  const TwoViewNormalEquations equations = linearizeTwoView(blocksOf(set), false, noise, {}, scene.R, scene.t);
  MotionPriors none;
  for (int i = 0; i < 6; ++i) {
    const double h = 1e-6;
    const auto at = [&](double step) -> Vector6d {
      const Vector6d d = step * Vector6d::Unit(i);
      return linearizeTwoView(blocksOf(set), false, noise, none, expSO3(d.tail<3>()) * scene.R, scene.t + d.head<3>())
          .g;
    };
    const Vector6d column = (at(h) - at(-h)) / (2.0 * h);
    EXPECT_LT((column - equations.H.col(i)).norm(), 1e-3 * equations.H.col(i).norm()) << i;
  }
  EXPECT_TRUE(gradientAt(Vector6d::Zero()).allFinite());
  const TwoViewNormalEquations single = linearizeTwoView(set.blocks(), false, noise, {}, scene.R, scene.t);
  EXPECT_LT((single.H - equations.H).norm(), 1e-4 * equations.H.norm());
}

TEST(TwoViewRefinement, FindsTheTruthFromPerturbedStarts) {
  for (const RigShape& rig : {monoShape(), stereoShape(), surroundShape()}) {
    for (unsigned seed = 1; seed <= 10; ++seed) {
      const CorrespondenceScene scene = makeCorrespondenceScene(rig, kRotation, kTranslation, 100, 0.0, 0.0, seed);
      const CorrespondenceSet set = scene.set();
      TwoViewRefinementOptions options;
      options.max_iterations = 60;
      const TwoViewEstimate found =
          refineTwoView(blocksOf(set), {}, options, 20.0,
                        startAt(expSO3({0.01, -0.012, 0.008}) * scene.R, scene.t + Eigen::Vector3d(0.02, 0.06, -0.04)));
      ASSERT_TRUE(found.success);
      EXPECT_LT(rotationErrorOf(found.R, scene), 1e-4);
      EXPECT_LT(directionErrorOf(found.R, found.t, scene), 2e-3);
      EXPECT_LT((found.R.transpose() * found.R - Eigen::Matrix3d::Identity()).norm(), 1e-12);
    }
  }
}

TEST(TwoViewRefinement, MeasuresTheImageNoise) {
  for (double noise_px : {0.2, 0.5, 0.8}) {
    const CorrespondenceScene scene =
        makeCorrespondenceScene(stereoShape(), kRotation, kTranslation, 300, noise_px, 0.0, 5);
    const CorrespondenceSet set = scene.set();
    const TwoViewEstimate found = refineTwoView(blocksOf(set), {}, {}, 4.0, startAt(scene.R, scene.t));
    ASSERT_TRUE(found.success);
    EXPECT_NEAR(found.pixel_sigma, noise_px, 0.07 * noise_px + 0.01);
  }
}

TEST(TwoViewRefinement, CovarianceIsThatOfTheErrors) {
  double squares = 0.0;
  const int runs = 60;
  for (unsigned seed = 1; seed <= runs; ++seed) {
    const CorrespondenceScene scene =
        makeCorrespondenceScene(surroundShape(), kRotation, kTranslation, 200, 0.5, 0.0, seed);
    // Priors as wrong as they say.
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    MotionPriors priors;
    const double sigma = 1e-3;
    priors.rotation = {expSO3(sigma * Eigen::Vector3d(normal(random), normal(random), normal(random))) * scene.R,
                       Eigen::Matrix3d::Identity() / (sigma * sigma)};
    priors.tilt.up_body2 = expSO3(sigma * Eigen::Vector3d(normal(random), normal(random), normal(random))) * scene.R *
                           priors.tilt.up_body1;
    priors.tilt.information = 1.0 / (sigma * sigma);
    priors.angle = {logSO3(scene.R).norm() + sigma * normal(random), 1.0 / (sigma * sigma)};
    const CorrespondenceSet set = scene.set();
    const TwoViewEstimate found = refineTwoView(blocksOf(set), priors, {}, kMaxError, startAt(scene.R, scene.t));
    ASSERT_TRUE(found.success);
    Vector6d d;
    d << scene.t - found.t, logSO3(scene.R * found.R.transpose());
    squares += squaredMahalanobis(d, found.covariance) / (6.0 * runs);
  }
  EXPECT_GT(squares, 0.8);
  EXPECT_LT(squares, 1.25);
}

TEST(TwoViewRefinement, StrongPriorsHoldTheRotation) {
  const CorrespondenceScene scene = makeCorrespondenceScene(stereoShape(), kRotation, kTranslation, 100, 0.5, 0.0, 5);
  const CorrespondenceSet set = scene.set();
  MotionPriors rotation;
  rotation.rotation = {expSO3({0.002, -0.001, 0.001}) * scene.R, 1e14 * Eigen::Matrix3d::Identity()};
  const TwoViewEstimate held = refineTwoView(blocksOf(set), rotation, {}, kMaxError, startAt(scene.R, scene.t));
  EXPECT_LT(logSO3(held.R * rotation.rotation.R.transpose()).norm(), 1e-6);

  MotionPriors tilt;
  tilt.tilt = {Eigen::Vector3d::UnitZ(), scene.R * Eigen::Vector3d::UnitZ(), 1e14};
  const TwoViewEstimate level = refineTwoView(blocksOf(set), tilt, {}, kMaxError, startAt(scene.R, scene.t));
  EXPECT_LT((level.R * tilt.tilt.up_body1 - tilt.tilt.up_body2).norm(), 1e-6);
  EXPECT_GT(rotationErrorOf(level.R, scene), 1e-6);

  MotionPriors angle;
  angle.angle = {logSO3(scene.R).norm(), 1e14};
  const TwoViewEstimate turned = refineTwoView(blocksOf(set), angle, {}, kMaxError, startAt(scene.R, scene.t));
  EXPECT_NEAR(logSO3(turned.R).norm(), angle.angle.angle, 1e-6);
}

TEST(TwoViewRefinement, FewOutliersHardlyMatter) {
  const CorrespondenceScene scene = makeCorrespondenceScene(surroundShape(), kRotation, kTranslation, 200, 0.3, 0.1, 6);
  const CorrespondenceSet set = scene.set();
  const TwoViewEstimate found =
      refineTwoView(blocksOf(set), {}, {}, kMaxError,
                    startAt(expSO3({0.001, 0.001, -0.001}) * scene.R, scene.t + Eigen::Vector3d(0.005, 0.005, -0.005)));
  EXPECT_LT(rotationErrorOf(found.R, scene), 2e-3);
  EXPECT_LT(directionErrorOf(found.R, found.t, scene), 0.05);
}

TEST(TwoViewRefinement, NaNIsNoSuccessAndNothingChangesNothing) {
  const CorrespondenceScene scene = makeCorrespondenceScene(stereoShape(), kRotation, kTranslation, 20, 0.5, 0.0, 7);
  const CorrespondenceSet set = scene.set();
  const Eigen::Vector3d nan(std::numeric_limits<double>::quiet_NaN(), 0.0, 0.0);
  EXPECT_FALSE(refineTwoView(blocksOf(set), {}, {}, kMaxError, startAt(scene.R, nan)).success);
  const TwoViewEstimate same = refineTwoView({}, {}, {}, kMaxError, startAt(scene.R, scene.t));
  EXPECT_LT((same.t - scene.t).norm(), 1e-12);
}

}  // namespace
}  // namespace multicam_egomotion
