// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numeric>

#include "correspondence_scene.h"
#include "multicam_egomotion/estimation/two_view_refinement.h"

namespace multicam_egomotion {
namespace {

const Eigen::Vector3d kRotation(0.02, -0.03, 0.08);
const Eigen::Vector3d kTranslation(-0.4, 0.1, 0.05);

std::vector<int> allOf(const CorrespondenceSet& set) {
  std::vector<int> positions(set.size());
  std::iota(positions.begin(), positions.end(), 0);
  return positions;
}

double rotationError(const Eigen::Matrix3d& R, const CorrespondenceScene& scene) {
  return logSO3(R * scene.R.transpose()).norm();
}

// Of the baseline of camera 0, which one camera sees as well as several.
double directionError(const Eigen::Matrix3d& R, const Eigen::Vector3d& t, const CorrespondenceScene& scene) {
  const Eigen::Vector3d& center = scene.centers[0];
  const Eigen::Vector3d truth = scene.R * center + scene.t - center, found = R * center + t - center;
  return std::acos(std::min(1.0, found.normalized().dot(truth.normalized())));
}

// The cost of the header: Cauchy loss of Sampson errors and the prior.
double costOf(const CorrespondenceSet& set, const RotationPrior& prior, const TwoViewRefinementOptions& options,
              const Eigen::Matrix3d& R, const Eigen::Vector3d& t) {
  std::vector<double> errors;
  set.squaredSampsonErrors(R, t, &errors);
  const double w2 = options.robust_width_px * options.robust_width_px;
  double sum = 0.0;
  for (double error : errors) sum += 0.5 * w2 * std::log1p(error / w2) / (options.pixel_sigma * options.pixel_sigma);
  const Eigen::Vector3d d = logSO3(R * prior.R.transpose());
  return sum + 0.5 * d.dot(prior.information * d);
}

TEST(TwoViewRefinement, FindsTheTruthFromPerturbedStarts) {
  TwoViewRefinementOptions options;
  options.max_iterations = 30;
  for (const RigShape& rig : {monoShape(), stereoShape(), surroundShape()}) {
    for (unsigned seed = 1; seed <= 10; ++seed) {
      const CorrespondenceScene scene = makeCorrespondenceScene(rig, kRotation, kTranslation, 100, 0.0, 0.0, seed);
      const CorrespondenceSet set = scene.set();
      Eigen::Matrix3d R = expSO3(Eigen::Vector3d(0.01, -0.012, 0.008)) * scene.R;
      Eigen::Vector3d t = scene.t + Eigen::Vector3d(0.02, 0.06, -0.04);
      ASSERT_TRUE(refineTwoView(set, allOf(set), {}, options, &R, &t));
      EXPECT_LT(rotationError(R, scene), 1e-5);
      EXPECT_LT(directionError(R, t, scene), 1e-4);
      if (rig.yaws.size() > 1) {
        EXPECT_LT((t - scene.t).norm(), 1e-3);
      }
      EXPECT_LT((R.transpose() * R - Eigen::Matrix3d::Identity()).norm(), 1e-12);
    }
  }
}

TEST(TwoViewRefinement, EndsAtAStationaryPointOfItsCost) {
  TwoViewRefinementOptions options;
  options.max_iterations = 50;
  const CorrespondenceScene scene = makeCorrespondenceScene(stereoShape(), kRotation, kTranslation, 150, 0.5, 0.0, 3);
  const CorrespondenceSet set = scene.set();
  RotationPrior prior{expSO3(Eigen::Vector3d(0.001, 0.0, -0.001)) * scene.R,
                      Eigen::Vector3d(1e6, 2e6, 5e5).asDiagonal()};
  Eigen::Matrix3d R = scene.R;
  Eigen::Vector3d t = scene.t;
  const double start = costOf(set, prior, options, R, t);
  ASSERT_TRUE(refineTwoView(set, allOf(set), prior, options, &R, &t));
  const double end = costOf(set, prior, options, R, t);
  EXPECT_LT(end, start);
  // The gradient leaves out the change of Sampson's denominator, so the end is a minimum to first order only: no small
  // step may gain more than a small part of what was gained.
  for (int c = 0; c < 6; ++c) {
    for (double sign : {-1.0, 1.0}) {
      Eigen::Matrix3d shifted_R = R;
      Eigen::Vector3d shifted_t = t;
      const Eigen::Vector3d unit = Eigen::Vector3d::Unit(c % 3);
      if (c < 3) {
        shifted_t += sign * 1e-4 * unit;
      } else {
        shifted_R = expSO3(sign * 1e-5 * unit) * R;
      }
      EXPECT_GT(costOf(set, prior, options, shifted_R, shifted_t), end - 0.02 * (start - end)) << c << " " << sign;
    }
  }
}

TEST(TwoViewRefinement, IsAsGoodAsTheNoiseAllows) {
  const TwoViewRefinementOptions options;
  double squares = 0.0;
  const int runs = 30;
  for (unsigned seed = 1; seed <= runs; ++seed) {
    const CorrespondenceScene scene =
        makeCorrespondenceScene(surroundShape(), kRotation, kTranslation, 200, 0.5, 0.0, seed);
    const CorrespondenceSet set = scene.set();
    Eigen::Matrix3d R = expSO3(Eigen::Vector3d(0.005, 0.004, -0.006)) * scene.R;
    Eigen::Vector3d t = scene.t + Eigen::Vector3d(0.01, 0.05, -0.03);
    ASSERT_TRUE(refineTwoView(set, allOf(set), {}, options, &R, &t));
    squares += std::pow(rotationError(R, scene), 2) / runs;
  }
  // 50 views a camera of 0.7 px at 400 px/rad constrain each axis to some 3e-4 rad.
  EXPECT_LT(std::sqrt(squares), 8e-4);
}

TEST(TwoViewRefinement, AStrongPriorHoldsTheRotation) {
  const CorrespondenceScene scene = makeCorrespondenceScene(stereoShape(), kRotation, kTranslation, 100, 0.5, 0.0, 5);
  const CorrespondenceSet set = scene.set();
  const Eigen::Matrix3d R_prior = expSO3(Eigen::Vector3d(0.002, -0.001, 0.001)) * scene.R;
  Eigen::Matrix3d R = scene.R;
  Eigen::Vector3d t = scene.t;
  ASSERT_TRUE(refineTwoView(set, allOf(set), {R_prior, 1e14 * Eigen::Matrix3d::Identity()}, {}, &R, &t));
  EXPECT_LT(logSO3(R * R_prior.transpose()).norm(), 1e-6);
}

TEST(TwoViewRefinement, FewOutliersHardlyMatter) {
  TwoViewRefinementOptions options;
  options.max_iterations = 30;
  const CorrespondenceScene scene = makeCorrespondenceScene(surroundShape(), kRotation, kTranslation, 200, 0.3, 0.1, 6);
  const CorrespondenceSet set = scene.set();
  Eigen::Matrix3d R = expSO3(Eigen::Vector3d(0.002, 0.002, -0.002)) * scene.R;
  Eigen::Vector3d t = scene.t + Eigen::Vector3d(0.01, 0.01, -0.01);
  ASSERT_TRUE(refineTwoView(set, allOf(set), {}, options, &R, &t));
  EXPECT_LT(rotationError(R, scene), 2e-3);
  EXPECT_LT(directionError(R, t, scene), 0.05);
}

TEST(TwoViewRefinement, NaNLeavesThePoseAsItWas) {
  const CorrespondenceScene scene = makeCorrespondenceScene(stereoShape(), kRotation, kTranslation, 20, 0.5, 0.0, 7);
  const CorrespondenceSet set = scene.set();
  Eigen::Matrix3d R = scene.R;
  Eigen::Vector3d t(std::numeric_limits<double>::quiet_NaN(), 0.0, 0.0);
  EXPECT_FALSE(refineTwoView(set, allOf(set), {}, {}, &R, &t));
  EXPECT_EQ(R, scene.R);
  t = scene.t;
  EXPECT_TRUE(refineTwoView(set, {}, {}, {}, &R, &t));  // nothing to fit: nothing changes
  EXPECT_LT((t - scene.t).norm(), 1e-12);
}

}  // namespace
}  // namespace multicam_egomotion
