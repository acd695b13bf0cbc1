// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>

#include "bundle_scene.h"
#include "multicam_egomotion/geometry/covariance.h"
#include "multicam_egomotion/odometry/window_marginals.h"

namespace multicam_egomotion {
namespace {

struct System {
  Eigen::MatrixXd vision_H, rest_H;
  Eigen::VectorXd vision_b, rest_b;
  Eigen::MatrixXd H() const { return vision_H + rest_H; }
  Eigen::VectorXd b() const { return vision_b + rest_b; }
};

System systemOf(BundleAdjustment* bundle, BundleOptions options) {
  options.inverse_distance_sigma = 1e3;
  System system;
  bundle->linearize(&system.vision_H, &system.vision_b, &system.rest_H, &system.rest_b, options);
  return system;
}

// Four poses, prior on the first, all factors, off their optimum a little.
BundleScene scene(const std::vector<Eigen::Vector3d>& centers, unsigned seed, double translation_sigma = 0.05) {
  BundleScene scene = makeBundleScene(4, 40, centers, 0.4, seed);
  addMotionFactors(&scene, 0.002, translation_sigma);
  setPrior(&scene, {0}, 1e5 * Eigen::MatrixXd::Identity(6, 6), 10.0 * Eigen::VectorXd::Ones(6));
  return scene;
}

Eigen::Isometry3d relativeOf(const BundlePose& a, const BundlePose& b) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = a.R.transpose() * b.R;
  T.translation() = a.R.transpose() * (b.p - a.p);
  return T;
}

// (position, rotation) by which T differs from T0, as PoseWithCovariance has it.
Eigen::Matrix<double, 6, 1> difference(const Eigen::Isometry3d& T0, const Eigen::Isometry3d& T) {
  Eigen::Matrix<double, 6, 1> d;
  d << T.translation() - T0.translation(), logSO3(T.linear() * T0.linear().transpose());
  return d;
}

TEST(WindowMarginals, MarginalizationKeepsAllInformationOfTheFirstPose) {
  const BundleOptions options;
  for (unsigned seed = 1; seed <= 5; ++seed) {
    BundleScene one = scene(stereoCenters(), seed);
    const System system = systemOf(&one.bundle, options);
    const PosePrior prior = marginalizeFirstPose(&one.bundle, options);
    ASSERT_EQ(prior.poses, (std::vector<int>{1, 2, 3}));
    const Eigen::MatrixXd covariance = symmetricInverse(system.H());
    const Eigen::MatrixXd kept = covariance.bottomRightCorner(18, 18);
    EXPECT_LT((prior.H * kept - Eigen::MatrixXd::Identity(18, 18)).norm(), 1e-4);
    // The same optimum: the gradient is that of the marginal.
    const Eigen::VectorXd step = symmetricSolve(system.H(), system.b());
    EXPECT_LT((symmetricSolve(prior.H, prior.b) - step.tail(18)).norm(), 1e-4 * step.norm());
    EXPECT_EQ(prior.H, prior.H.transpose());
    for (int i = 0; i < 3; ++i) {
      EXPECT_EQ(localDifference(prior.linearization[i], one.bundle.poses[i + 1]).norm(), 0.0);
    }
  }
}

TEST(WindowMarginals, APriorOfMarginalizationReplacesThePose) {
  // Solving with the first pose gone and its prior in place gives the same remaining poses.
  BundleOptions options;
  options.max_iterations = 20;
  options.relative_decrease = 1e-14;
  options.inverse_distance_sigma = 1e3;
  BundleScene one = scene(stereoCenters(), 3);
  one.bundle.solve(options);
  BundleAdjustment leaving = one.bundle;
  const PosePrior prior = marginalizeFirstPose(&leaving, options);
  BundleAdjustment rest;
  rest.poses.assign(one.bundle.poses.begin() + 1, one.bundle.poses.end());
  rest.prior = prior;
  for (int& pose : rest.prior.poses) --pose;
  for (BundlePose& pose : rest.poses) pose.p += Eigen::Vector3d(0.001, -0.002, 0.001);
  rest.solve(options);
  for (std::size_t i = 0; i < rest.poses.size(); ++i) {
    EXPECT_LT(localDifference(one.bundle.poses[i + 1], rest.poses[i]).norm(), 1e-5);
  }
}

TEST(WindowMarginals, CovariancesAreThoseOfTheDenseSolution) {
  const BundleOptions options;
  BundleScene one = scene(stereoCenters(), 2);
  const System system = systemOf(&one.bundle, options);
  WindowEstimate estimate;
  computeMarginals(&one.bundle, options, 1.0, &estimate);
  const BundlePose previous = one.bundle.poses[2], newest = one.bundle.poses[3];
  const Eigen::Isometry3d T = relativeOf(previous, newest);
  EXPECT_LT(difference(T, estimate.relative.T_a_b).norm(), 1e-12);

  // Jacobian of the relative motion by numeric perturbation of both poses.
  Eigen::Matrix<double, 6, 12> J;
  for (int c = 0; c < 12; ++c) {
    const double step = 1e-6;
    Eigen::Matrix<double, 6, 1> d = Eigen::Matrix<double, 6, 1>::Zero();
    d[c % 6] = step;
    J.col(c) =
        difference(T, c < 6 ? relativeOf(retract(previous, d), newest) : relativeOf(previous, retract(newest, d))) /
        step;
  }
  const Eigen::MatrixXd all = symmetricInverse(system.H()).bottomRightCorner(12, 12);
  const Matrix6d expected = propagated(J, all);
  EXPECT_LT((estimate.relative.covariance - expected).norm(), 1e-3 * expected.norm());

  // Vision alone, the first pose fixed.
  const Eigen::MatrixXd vision = symmetricInverse(system.vision_H.bottomRightCorner(18, 18)).bottomRightCorner(12, 12);
  const Matrix6d expected_vision = propagated(J, vision);
  EXPECT_LT((estimate.vision.covariance - expected_vision).norm(), 1e-3 * expected_vision.norm());

  // The absolute pose in odom axes.
  Matrix6d to_odom = Matrix6d::Zero();
  to_odom.topLeftCorner<3, 3>() = to_odom.bottomRightCorner<3, 3>() = newest.R;
  const Matrix6d expected_pose = to_odom * all.bottomRightCorner(6, 6) * to_odom.transpose();
  EXPECT_LT((estimate.covariance - expected_pose).norm(), 1e-3 * expected_pose.norm());
}

TEST(WindowMarginals, WhatStaysTheSameInBothFramesDoesNotCountBetweenThem) {
  const BundleOptions options;
  BundleScene one = scene(stereoCenters(), 2);
  one.bundle.factors.clear();
  WindowEstimate all, quarter;
  computeMarginals(&one.bundle, options, 1.0, &all);
  computeMarginals(&one.bundle, options, 0.25, &quarter);
  EXPECT_LT((quarter.vision.covariance - 0.25 * all.vision.covariance).norm(), 1e-3 * all.vision.covariance.norm());
  EXPECT_LT((quarter.covariance - all.covariance).norm(), 1e-9) << "the pose in odom has all of the noise";
  EXPECT_EQ(quarter.scale_sigma, all.scale_sigma);
}

TEST(WindowMarginals, VisionAloneIsTheStepWithoutTheFactors) {
  // At the optimum of images and a wrong gyroscope, vision's own motion is that of the images alone.
  BundleOptions options;
  options.max_iterations = 20;
  options.relative_decrease = 1e-12;
  options.inverse_distance_sigma = 1e3;
  options.robust_width = 1e3;
  BundleScene honest = scene(stereoCenters(), 5);
  honest.bundle.factors.clear();
  BundleScene misled = honest;
  addMotionFactors(&misled, 2e-4, 0.0);
  for (MotionFactor& factor : misled.bundle.factors) factor.R_a_b = factor.R_a_b * expSO3({0.001, -0.001, 0.0005});
  honest.bundle.solve(options);
  misled.bundle.solve(options);
  WindowEstimate one, other;
  computeMarginals(&honest.bundle, options, 1.0, &one);
  computeMarginals(&misled.bundle, options, 1.0, &other);
  const double moved = logSO3(one.relative.T_a_b.linear().transpose() * other.relative.T_a_b.linear()).norm();
  const double vision_moved = logSO3(one.vision.T_a_b.linear().transpose() * other.vision.T_a_b.linear()).norm();
  EXPECT_GT(moved, 3e-4);
  EXPECT_LT(vision_moved, 0.05 * moved);
}

TEST(WindowMarginals, OneCameraSeesNoScaleAndTwoDo) {
  const BundleOptions options;
  BundleScene mono = scene({{0.0, 0.0, 0.0}}, 4), stereo = scene(stereoCenters(), 4);
  WindowEstimate estimate;
  computeMarginals(&mono.bundle, options, 1.0, &estimate);
  EXPECT_EQ(estimate.scale_state, ScaleState::kUnobservable) << estimate.scale_sigma;
  computeMarginals(&stereo.bundle, options, 1.0, &estimate);
  EXPECT_EQ(estimate.scale_state, ScaleState::kObservable) << estimate.scale_sigma;
}

TEST(WindowMarginals, ScaleIsNotTakenFromVelocity) {
  const BundleOptions options;
  BundleScene mono = scene({{0.0, 0.0, 0.0}}, 4, 1e-4);  // the displacement is known to 0.1 mm
  WindowEstimate estimate;
  computeMarginals(&mono.bundle, options, 1.0, &estimate);
  EXPECT_EQ(estimate.scale_state, ScaleState::kUnobservable) << estimate.scale_sigma;
  const Eigen::Vector3d direction = estimate.relative.T_a_b.translation().normalized();
  EXPECT_LT(direction.dot(estimate.relative.covariance.topLeftCorner<3, 3>() * direction), 1e-7);
}

TEST(WindowMarginals, StandingHasNoScale) {
  BundleScene still = makeBundleScene(2, 60, stereoCenters(), 0.4, 6);
  BundleAdjustment bundle = still.bundle;
  Noise noise(7);
  bundle.poses[1] = bundle.poses[0];
  for (std::size_t l = 0; l < bundle.landmarks.size(); ++l) {
    std::vector<BundleObservation>& views = bundle.landmarks[l].observations;
    for (int k : {0, 1}) views[2 + k] = observe(bundle.poses[1], 1, stereoCenters()[k], still.points[l], 0.4, &noise);
  }
  BundleOptions options;
  bundle.solve(options);
  WindowEstimate estimate;
  computeMarginals(&bundle, options, 1.0, &estimate);
  EXPECT_EQ(estimate.scale_state, ScaleState::kNotApplicable);
}

TEST(WindowMarginals, CovariancesArePositiveDefiniteWhateverIsSeen) {
  const BundleOptions options;
  for (const auto& centers : {std::vector<Eigen::Vector3d>{{0.0, 0.0, 0.0}}, stereoCenters()}) {
    for (double translation_sigma : {0.0, 0.1}) {
      BundleScene one = scene(centers, 9, translation_sigma);
      for (BundleLandmark& landmark : one.bundle.landmarks) landmark.inverse_distance = 0.0;
      WindowEstimate estimate;
      computeMarginals(&one.bundle, options, 1.0, &estimate);
      for (const Matrix6d& covariance :
           {estimate.covariance, estimate.relative.covariance, estimate.vision.covariance}) {
        EXPECT_GT(symmetricEigenvalues(covariance)[0], 0.0);
        EXPECT_TRUE(covariance.allFinite());
      }
      EXPECT_FALSE(std::isnan(estimate.scale_sigma));
    }
  }
}

}  // namespace
}  // namespace multicam_egomotion
