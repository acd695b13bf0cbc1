// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "bundle_scene.h"
#include "dense_bundle.h"
#include "multicam_egomotion/geometry/covariance.h"

namespace multicam_egomotion {
namespace {

using Vector6d = Eigen::Matrix<double, 6, 1>;

Eigen::MatrixXd randomInformation(int size, double scale, Noise* noise) {
  Eigen::MatrixXd A(size, size);
  for (int i = 0; i < size * size; ++i) A(i / size, i % size) = noise->gaussian();
  return scale * (A * A.transpose() + 0.1 * size * Eigen::MatrixXd::Identity(size, size));
}

// A scene with everything in it, away from its optimum.
BundleScene perturbedScene(unsigned seed, double prior_scale) {
  BundleScene scene = makeBundleScene(3, 12, stereoCenters(), 0.7, seed);
  addMotionFactors(&scene, 0.01, 0.05);
  Noise noise(seed + 1000);
  for (MotionFactor& factor : scene.bundle.factors) {
    factor.rotation_information = randomInformation(3, 1e3, &noise);
    factor.translation_information = randomInformation(3, 1e2, &noise);
  }
  Eigen::VectorXd b(12);
  for (int i = 0; i < 12; ++i) b[i] = prior_scale * noise.gaussian();
  setPrior(&scene, {0, 2}, randomInformation(12, prior_scale, &noise), b);
  return scene;
}

void perturbPoses(BundleScene* scene, double position, double rotation, Noise* noise, int first = 0) {
  for (std::size_t i = first; i < scene->poses.size(); ++i) {
    scene->bundle.poses[i] = retract(scene->poses[i], noise->pose(position, rotation));
  }
}

// Without the prior on inverse distances, which would draw the solution away from the truth.
BundleOptions unbiasedOptions() {
  BundleOptions options;
  options.inverse_distance_sigma = 1e4;
  return options;
}

double largestPoseError(const BundleScene& scene, bool rotation) {
  double largest = 0.0;
  for (std::size_t i = 0; i < scene.poses.size(); ++i) {
    const Vector6d d = localDifference(scene.poses[i], scene.bundle.poses[i]);
    largest = std::max(largest, rotation ? d.tail<3>().norm() : d.head<3>().norm());
  }
  return largest;
}

TEST(BundleAdjustment, RetractAndLocalDifferenceAreInverse) {
  Noise noise(1);
  for (int i = 0; i < 100; ++i) {
    const BundlePose a = retract(BundlePose(), noise.pose(3.0, 1.0));
    const Vector6d d = noise.pose(1.0, 0.5);
    EXPECT_LT((localDifference(a, retract(a, d)) - d).norm(), 1e-12);
    EXPECT_LT((a.R * d.head<3>() + a.p - retract(a, d).p).norm(), 1e-12);
  }
}

TEST(BundleAdjustment, GradientIsThatOfTheCost) {
  BundleOptions options;
  options.inverse_distance_sigma = 0.02;  // strong, so that it shows
  for (unsigned seed = 1; seed <= 5; ++seed) {
    BundleScene scene = perturbedScene(seed, 0.0);
    Noise noise(seed + 50);
    perturbPoses(&scene, 0.002, 0.001, &noise);
    scene.bundle.prior = BundlePrior();
    // Landmarks at their conditional optimum, where the reduced gradient is the gradient by the poses alone.
    BundleAdjustment bundle = scene.bundle;
    for (int repetition = 0; repetition < 40; ++repetition) {
      Eigen::MatrixXd H;
      Eigen::VectorXd b;
      DenseBundle(bundle).linearize(bundle, options, &H, &b);
      for (std::size_t l = 0; l < bundle.landmarks.size(); ++l) {
        const int at = 18 + 3 * static_cast<int>(l);
        bundle.landmarks[l] = moved(bundle.landmarks[l], symmetricSolve(H.block<3, 3>(at, at), b.segment<3>(at)));
      }
    }
    Eigen::MatrixXd vision_H, rest_H;
    Eigen::VectorXd vision_b, rest_b;
    bundle.linearize(&vision_H, &vision_b, &rest_H, &rest_b, options);
    const Eigen::VectorXd b = vision_b + rest_b;
    const double step = 1e-6;
    for (int c = 0; c < 18; ++c) {
      BundleAdjustment ahead = bundle, behind = bundle;
      ahead.poses[c / 6] = retract(bundle.poses[c / 6], step * Vector6d::Unit(c % 6));
      behind.poses[c / 6] = retract(bundle.poses[c / 6], -step * Vector6d::Unit(c % 6));
      const double derivative = (costOf(ahead, options) - costOf(behind, options)) / (2.0 * step);
      EXPECT_NEAR(-b[c], derivative, 1e-4 * b.norm()) << "seed " << seed << " unknown " << c;
    }
  }
}

TEST(BundleAdjustment, GradientOfThePriorIsThatOfTheCost) {
  // Away from the linearization by a degree and 2 cm, as a window's states move while the prior lasts.
  const BundleOptions options;
  BundleScene scene = perturbedScene(3, 100.0);
  Noise noise(9);
  perturbPoses(&scene, 0.02, 0.01, &noise);
  BundleAdjustment bundle = scene.bundle;
  bundle.landmarks.clear();
  bundle.factors.clear();
  Eigen::MatrixXd vision_H, rest_H;
  Eigen::VectorXd vision_b, rest_b;
  bundle.linearize(&vision_H, &vision_b, &rest_H, &rest_b, options);
  EXPECT_EQ(vision_H.norm(), 0.0);
  const double step = 1e-6;
  for (int c = 0; c < 18; ++c) {
    BundleAdjustment ahead = bundle, behind = bundle;
    ahead.poses[c / 6] = retract(bundle.poses[c / 6], step * Vector6d::Unit(c % 6));
    behind.poses[c / 6] = retract(bundle.poses[c / 6], -step * Vector6d::Unit(c % 6));
    const double derivative = (costOf(ahead, options) - costOf(behind, options)) / (2.0 * step);
    // The prior's Hessian is kept, so the derivative holds to the order of the rotation from the linearization.
    EXPECT_NEAR(-rest_b[c], derivative, 0.03 * rest_b.norm()) << "unknown " << c;
    if (c / 6 == 1) {
      EXPECT_EQ(rest_b[c], 0.0);
    }
  }
}

TEST(BundleAdjustment, NormalEquationsEqualTheDenseSchurComplement) {
  const BundleOptions options;
  for (unsigned seed = 1; seed <= 3; ++seed) {
    BundleScene scene = perturbedScene(seed, 0.0);
    Noise noise(seed);
    perturbPoses(&scene, 0.005, 0.002, &noise);
    Eigen::MatrixXd H, reduced_H, vision_H, rest_H;
    Eigen::VectorXd b, reduced_b, vision_b, rest_b;
    DenseBundle(scene.bundle).linearize(scene.bundle, options, &H, &b);
    eliminateLast(H, b, 18, &reduced_H, &reduced_b);
    scene.bundle.linearize(&vision_H, &vision_b, &rest_H, &rest_b, options);
    EXPECT_LT((vision_H - reduced_H).norm(), 1e-4 * reduced_H.norm());
    EXPECT_LT((vision_b - reduced_b).norm(), 1e-4 * reduced_b.norm());
    EXPECT_LT((vision_H - vision_H.transpose()).norm(), 1e-9 * vision_H.norm());
  }
}

TEST(BundleAdjustment, ConvergesToTheTruthFromPerturbedStarts) {
  BundleOptions options = unbiasedOptions();
  options.max_iterations = 20;
  options.relative_decrease = 1e-12;
  for (unsigned seed = 1; seed <= 10; ++seed) {
    BundleScene scene = makeBundleScene(5, 60, stereoCenters(), 0.0, seed);
    Noise noise(seed + 77);
    perturbPoses(&scene, 0.05, 0.02, &noise, 1);
    for (BundleLandmark& landmark : scene.bundle.landmarks) {
      landmark = moved(landmark, {noise.gaussian(0.01), noise.gaussian(0.01), 0.0});
      landmark.inverse_distance *= std::exp(noise.gaussian(0.3));
    }
    const BundleSummary summary = scene.bundle.solve(options);
    EXPECT_TRUE(summary.finite);
    EXPECT_LT(summary.cost, 1e-6) << "seed " << seed;
    EXPECT_LT(largestPoseError(scene, false), 1e-5) << "seed " << seed;
    EXPECT_LT(largestPoseError(scene, true), 1e-6) << "seed " << seed;
    EXPECT_LT(localDifference(scene.poses[0], scene.bundle.poses[0]).norm(), 1e-12) << "the gauge moved";
  }
}

TEST(BundleAdjustment, OneStepNearTheOptimumIsTheDenseOne) {
  BundleOptions options = unbiasedOptions();
  options.max_iterations = 1;
  options.robust_width = 1e6;  // plain least squares
  BundleScene scene = makeBundleScene(3, 25, stereoCenters(), 0.5, 8);
  Noise noise(2);
  perturbPoses(&scene, 0.002, 0.001, &noise, 1);
  Eigen::MatrixXd H;
  Eigen::VectorXd b;
  DenseBundle(scene.bundle).linearize(scene.bundle, options, &H, &b);
  const Eigen::VectorXd step = symmetricSolve(H.bottomRightCorner(H.rows() - 6, H.rows() - 6), b.tail(H.rows() - 6));
  const std::vector<BundlePose> before = scene.bundle.poses;
  scene.bundle.solve(options);
  for (int i = 1; i < 3; ++i) {
    const Vector6d done = localDifference(before[i], scene.bundle.poses[i]);
    const Vector6d expected = step.segment<6>(6 * (i - 1));
    EXPECT_LT((done - expected).norm(), 2e-3 * expected.norm());
  }
}

TEST(BundleAdjustment, OutliersHardlyMoveTheSolution) {
  BundleOptions options = unbiasedOptions();
  options.max_iterations = 30;
  BundleScene clean = makeBundleScene(4, 80, stereoCenters(), 0.3, 5), spoiled = clean;
  Noise noise(6);
  for (std::size_t l = 0; l < spoiled.bundle.landmarks.size(); l += 10) {
    BundleObservation& view = spoiled.bundle.landmarks[l].observations[3];
    view.bearing = (view.bearing + noise.vector(0.05)).normalized();
  }
  clean.bundle.solve(options);
  spoiled.bundle.solve(options);
  EXPECT_LT(largestPoseError(spoiled, false), 3.0 * largestPoseError(clean, false) + 1e-3);
}

TEST(BundleAdjustment, DoesNotDependOnTheFrameOfTheWorld) {
  BundleOptions options;
  options.max_iterations = 8;
  BundleScene scene = perturbedScene(11, 50.0);
  Noise noise(12);
  perturbPoses(&scene, 0.01, 0.005, &noise);
  BundleScene turned = scene;
  const Eigen::Matrix3d R = expSO3({0.7, -1.1, 2.0});
  const Eigen::Vector3d p(20.0, -7.0, 3.0);
  const auto turn = [&](BundlePose* pose) {
    pose->R = R * pose->R;
    pose->p = R * pose->p + p;
  };
  for (BundlePose& pose : turned.bundle.poses) turn(&pose);
  for (BundlePose& pose : turned.bundle.prior.linearization) turn(&pose);
  for (BundleLandmark& landmark : turned.bundle.landmarks) {
    landmark.origin = R * landmark.origin + p;
    landmark.direction = R * landmark.direction;
  }
  const BundleSummary one = scene.bundle.solve(options), other = turned.bundle.solve(options);
  EXPECT_NEAR(one.cost, other.cost, 1e-6 * one.cost);
  for (std::size_t i = 0; i < scene.bundle.poses.size(); ++i) {
    BundlePose expected = scene.bundle.poses[i];
    turn(&expected);
    EXPECT_LT(localDifference(expected, turned.bundle.poses[i]).norm(), 1e-6);
  }
}

TEST(BundleAdjustment, CostNeverRises) {
  BundleOptions options;
  for (unsigned seed = 1; seed <= 10; ++seed) {
    BundleScene scene = makeBundleScene(4, 30, stereoCenters(), 0.5, seed);
    addMotionFactors(&scene, 0.001, 0.0);
    Noise noise(seed);
    perturbPoses(&scene, 0.4, 0.2, &noise, 1);
    double last = std::numeric_limits<double>::infinity();
    options.max_iterations = 1;
    for (int i = 0; i < 12; ++i) {
      const BundleSummary summary = scene.bundle.solve(options);
      EXPECT_LE(summary.cost, last * (1.0 + 1e-12));
      last = summary.cost;
    }
  }
}

TEST(BundleAdjustment, PointsBehindCamerasAndAtInfinityGiveNoNaN) {
  BundleOptions options;
  BundleScene scene = makeBundleScene(4, 40, stereoCenters(), 0.5, 21);
  for (std::size_t l = 0; l < scene.bundle.landmarks.size(); ++l) {
    BundleLandmark& landmark = scene.bundle.landmarks[l];
    if (l % 5 == 0) landmark.direction = -landmark.direction;
    if (l % 5 == 1) landmark.inverse_distance = 0.0;
    if (l % 5 == 2) landmark.inverse_distance = -0.2;
    if (l % 5 == 3) landmark.inverse_distance = 1e4;
  }
  const BundleObservation& view = scene.bundle.landmarks[0].observations[0];
  EXPECT_LT(scene.bundle.normalizedError(scene.bundle.landmarks[0], view), 0.0);
  const BundleSummary summary = scene.bundle.solve(options);
  EXPECT_TRUE(summary.finite);
  EXPECT_TRUE(std::isfinite(summary.cost));
  for (const BundlePose& pose : scene.bundle.poses) {
    EXPECT_TRUE(pose.p.allFinite());
    EXPECT_LT((pose.R.transpose() * pose.R - Eigen::Matrix3d::Identity()).norm(), 1e-12);
  }
  for (const BundleLandmark& landmark : scene.bundle.landmarks) {
    EXPECT_TRUE(landmark.direction.allFinite());
    EXPECT_TRUE(std::isfinite(landmark.inverse_distance));
  }
}

TEST(BundleAdjustment, FixedLandmarksStayAndFreeAllPoses) {
  BundleScene scene = makeBundleScene(2, 60, stereoCenters(), 0.0, 14);
  Noise noise(15);
  perturbPoses(&scene, 0.05, 0.02, &noise);
  const std::vector<BundleLandmark> before = scene.bundle.landmarks;
  BundleOptions options = unbiasedOptions();
  options.fix_landmarks = true;
  options.max_iterations = 15;
  options.relative_decrease = 1e-12;
  EXPECT_TRUE(scene.bundle.solve(options).finite);
  EXPECT_LT(largestPoseError(scene, false), 1e-5);
  EXPECT_LT(largestPoseError(scene, true), 1e-6);
  for (std::size_t l = 0; l < before.size(); ++l) {
    EXPECT_EQ(before[l].direction, scene.bundle.landmarks[l].direction);
    EXPECT_EQ(before[l].inverse_distance, scene.bundle.landmarks[l].inverse_distance);
  }
}

TEST(BundleAdjustment, NothingToEstimateIsNoFault) {
  BundleAdjustment bundle;
  bundle.poses.resize(1);
  EXPECT_TRUE(bundle.solve({}).finite);
  bundle.poses.resize(2);
  const BundleSummary summary = bundle.solve({});
  EXPECT_TRUE(summary.finite);
  EXPECT_EQ(summary.cost, 0.0);
}

TEST(BundleAdjustment, MeasuresTheImageNoise) {
  BundleOptions options = unbiasedOptions();
  for (double noise_px : {0.25, 1.0}) {
    BundleScene scene = makeBundleScene(5, 100, stereoCenters(), noise_px, 31);
    scene.bundle.pixel_sigma = noise_px;
    options.max_iterations = 10;
    const BundleSummary summary = scene.bundle.solve(options);
    // E[w s] / E[2 w] of s = chi-square of two dimensions and w = 1 / (1 + s / 4) is 0.77.
    const double ratio = summary.weighted_square_sum / summary.degrees_of_freedom;
    EXPECT_NEAR(ratio, 0.77, 0.08);
  }
}

}  // namespace
}  // namespace multicam_egomotion
