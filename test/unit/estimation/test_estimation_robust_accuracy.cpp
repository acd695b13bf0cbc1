// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <iostream>

#include "robust_trials.h"
#include "solver_trials.h"

namespace multicam_egomotion {
namespace {

OracleComparison compare(TrialSetup setup, int trials) {
  RobustEstimatorOptions options;
  options.max_samples = 2000;
  OracleComparison comparison;
  for (const Motion motion : {Motion::kRandom, Motion::kForward, Motion::kSideways}) {
    setup.motion = motion;
    for (int i = 0; i < trials; ++i) {
      const RobustTrial trial = makeRobustTrial(setup, 1 + i);
      comparison.add(estimate<FourPointVertical>(trial.set(), trial.vertical, {}, options, i), trial,
                     oracleEstimate(trial, {}, options));
    }
  }
  return comparison;
}

// Outliers cost next to nothing: beside the same refinement started at the truth on the true inliers.
TEST(RobustAccuracy, IsThatOfAnOracle) {
  for (const double outliers : {0.3, 0.6}) {
    TrialSetup setup;
    setup.outliers = outliers;
    const OracleComparison comparison = compare(setup, 60);
    EXPECT_EQ(comparison.failures, 0);
    EXPECT_LT(comparison.ratio(0.5), 1.12) << outliers;  // 1.05 over 1000 trials
    EXPECT_LT(comparison.ratio(0.9), 1.15) << outliers;
    EXPECT_GT(comparison.nees(), 0.8);
    EXPECT_LT(comparison.nees(), 1.25);
  }
}

// The paper's degeneracy (section IV-D): scale is not observable, and the covariance says so.
TEST(RobustAccuracy, PureTranslationWithoutCrossCameraLeavesScaleOpen) {
  TrialSetup setup;
  setup.outliers = 0.3;
  setup.max_rotation_deg = 0.0;
  const unsigned trials_per_motion = solverTrials(40);
  int trials = 0, open = 0, direction = 0;
  for (const Motion motion : {Motion::kRandom, Motion::kForward, Motion::kSideways}) {
    setup.motion = motion;
    for (unsigned seed = 1; seed <= trials_per_motion; ++seed, ++trials) {
      const RobustTrial trial = makeRobustTrial(setup, seed);
      const RobustEstimate found = estimate<FourPointVertical>(trial.set(), trial.vertical, {}, {}, seed);
      ASSERT_TRUE(found.success);
      open += found.scale.sigma > 0.5;
      direction += directionError(found.t, trial.t) < 0.1 && rotationError(found.R, trial.R) < 0.01;
    }
  }
  std::cout << trials << " trials, scale open in " << open << ", direction right in " << direction << "\n";
  EXPECT_GE(open, 0.99 * trials);
  EXPECT_GE(direction, 0.98 * trials);
}

TEST(RobustAccuracy, ScaleIsSeenWithRotationOrCrossCameraCorrespondences) {
  TrialSetup setup;
  setup.cross_camera = true;
  setup.max_rotation_deg = 0.0;
  int seen = 0;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const RobustTrial trial = makeRobustTrial(setup, seed);
    const RobustEstimate found = estimate<FourPointVertical>(trial.set(), trial.vertical, {}, {}, seed);
    seen += found.scale.state == ScaleState::kObservable &&
            std::abs(found.t.norm() / trial.t.norm() - 1.0) < 4.0 * found.scale.sigma;
  }
  EXPECT_GE(seen, 19);
}

TEST(InlierWeights, OutliersOnTheLineAtADistanceOfNoInlierAreDropped) {
  CorrespondenceSet::Residuals residuals;
  const auto add = [&](double error, double nearness, double parallax) {
    residuals.errors.push_back(error);
    residuals.nearness.push_back(nearness);
    residuals.leverages.push_back(parallax * parallax);
  };
  for (int i = 0; i < 100; ++i) add(0.01 * i, 0.1, 0.05);
  add(0.1, 3.0, 0.6);                                       // fits, but is far too near
  for (int i = 0; i < 20; ++i) add(5.0 + 2 * i, 3.0, 0.6);  // as its like, which do not fit
  std::vector<double> weights;
  weighInliers(residuals, 0.5, 2.0, &weights);
  for (int i = 0; i < 100; ++i) EXPECT_GT(weights[i], 0.5) << i;
  for (int i = 100; i < 121; ++i) EXPECT_EQ(weights[i], 0.0) << i;

  // Without outliers there is no reason to drop it, only to weigh it less.
  for (auto* column : {&residuals.errors, &residuals.nearness, &residuals.leverages}) column->resize(101);
  weighInliers(residuals, 0.5, 2.0, &weights);
  EXPECT_GT(weights[100], 0.0);
  EXPECT_LT(weights[100], 0.3 * weights[0]);
}

TEST(ScaleObservability, FollowsItsDefinition) {
  const Eigen::Vector3d t(2.0, 0.0, 0.0);
  const auto state = [&](double along, double across) {
    return scaleObservability(t, Eigen::Vector3d(along * along, across * across, across * across).asDiagonal());
  };
  EXPECT_NEAR(state(0.1, 0.05).sigma, 0.05, 1e-12);
  EXPECT_EQ(state(0.1, 0.05).state, ScaleState::kObservable);
  EXPECT_EQ(state(0.6, 0.05).state, ScaleState::kWeak);
  EXPECT_EQ(state(50.0, 0.05).state, ScaleState::kUnobservable);
  EXPECT_EQ(state(0.9, 0.9).state, ScaleState::kNotApplicable);
  EXPECT_EQ(state(50.0, 0.9).state, ScaleState::kNotApplicable);
  EXPECT_EQ(scaleObservability(Eigen::Vector3d::Zero(), Eigen::Matrix3d::Identity()).state, ScaleState::kNotApplicable);
}

}  // namespace
}  // namespace multicam_egomotion
