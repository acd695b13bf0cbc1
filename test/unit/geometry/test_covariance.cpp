// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "multicam_egomotion/geometry/covariance.h"

namespace multicam_egomotion {
namespace {

// With eigenvalues 1, 4 and 9.
Eigen::Matrix3d example() {
  const Eigen::Vector3d axis = Eigen::Vector3d(1, 2, 2) / 3;
  const Eigen::Matrix3d mirror = Eigen::Matrix3d::Identity() - 2 * axis * axis.transpose();
  return mirror * Eigen::Vector3d(4, 1, 9).asDiagonal() * mirror.transpose();
}

TEST(Covariance, PropagationIsThatOfTheLinearMapAndSymmetric) {
  Eigen::Matrix<double, 2, 3> F;
  F << 1, 0.3, -2, 0.7, 0, 5;
  const Eigen::MatrixXd P = propagated(F, example());
  EXPECT_LT((P - F * example() * F.transpose()).norm(), 1e-12);
  EXPECT_EQ(P, P.transpose());
}

TEST(Covariance, InverseSolutionAndDistanceAgree) {
  const Eigen::Matrix3d P = example();
  const Eigen::Vector3d x(0.2, -1, 3);
  EXPECT_LT((symmetricInverse(P) * P - Eigen::Matrix3d::Identity()).norm(), 1e-13);
  EXPECT_LT((P * symmetricSolve(P, x) - x).norm(), 1e-13);
  EXPECT_NEAR(squaredMahalanobis(x, P), x.dot(P.inverse() * x), 1e-12);
  EXPECT_NEAR(squaredMahalanobis(x, 4 * Eigen::Matrix3d::Identity()), x.squaredNorm() / 4, 1e-15);
}

TEST(Covariance, EigenvaluesAscend) {
  EXPECT_LT((symmetricEigenvalues(example()) - Eigen::Vector3d(1, 4, 9)).norm(), 1e-13);
}

TEST(Covariance, OnlySmallEigenvaluesAreRaised) {
  EXPECT_LT((withEigenvaluesRaised(example(), 0.5, 0.01) - example()).norm(), 1e-13);
  const Eigen::MatrixXd raised = withEigenvaluesRaised(example(), 2, 0.01);
  EXPECT_LT((symmetricEigenvalues(raised) - Eigen::Vector3d(2, 4, 9)).norm(), 1e-13);
  EXPECT_LT((raised * example() - example() * raised).norm(), 1e-12);  // the same eigenvectors
  EXPECT_NEAR(symmetricEigenvalues(withEigenvaluesRaised(example(), 0, 0.5))[0], 4.5, 1e-13);
}

TEST(Covariance, WhatIsNotPositiveDefiniteIsTold) {
  Eigen::Matrix3d P = example();
  EXPECT_TRUE(isPositiveDefinite(P));
  EXPECT_FALSE(isPositiveDefinite(P - 2 * Eigen::Matrix3d::Identity()));
  EXPECT_FALSE(isPositiveDefinite(Eigen::Matrix3d::Zero()));
  P(0, 1) += 1e-3;  // not symmetric
  EXPECT_FALSE(isPositiveDefinite(P));
  P(0, 1) = P(1, 0) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(isPositiveDefinite(P));
}

}  // namespace
}  // namespace multicam_egomotion
