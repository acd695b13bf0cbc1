// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "bundle_scene.h"
#include "dense_bundle.h"

namespace multicam_egomotion {
namespace {

using Vector6d = Eigen::Matrix<double, 6, 1>;

constexpr double kDegree = M_PI / 180.0;

void removeCameras(const std::vector<int>& gone, BundleLandmark* landmark) {
  std::vector<BundleObservation> kept;
  for (const BundleObservation& view : landmark->observations) {
    if (std::find(gone.begin(), gone.end(), view.camera) == gone.end()) kept.push_back(view);
  }
  landmark->observations = kept;
}

// Three poses and cameras, everything away from its optimum. Landmarks are seen by all cameras, by two or by one.
BundleScene calibratedScene(unsigned seed, double offset_sigma) {
  BundleScene scene = makeBundleScene(3, 21, threeCenters(), 0.7, seed);
  Noise noise(seed + 300);
  const std::vector<std::vector<int>> gone = {{}, {2}, {0}, {1}, {1, 2}, {0, 2}, {0, 1}};
  for (std::size_t l = 0; l < scene.bundle.landmarks.size(); ++l) {
    BundleLandmark& landmark = scene.bundle.landmarks[l];
    removeCameras(gone[l % gone.size()], &landmark);
    for (BundleObservation& view : landmark.observations) {
      placeInImage(threeCenters()[0], &view);
      const bool further = view.camera != landmark.observations.front().camera;
      if (offset_sigma > 0.0 && further && view.pose == 0) {
        landmark.offsets[view.camera] = {noise.gaussian(0.2), noise.gaussian(0.2)};
      }
    }
  }
  for (BundlePose& pose : scene.bundle.poses) pose = retract(pose, noise.pose(0.002, 0.001));
  const BundleCalibration exact = threeCameraCalibration();
  scene.bundle.calibration = exact.retracted(calibrationNoise(exact, 0.002, &noise));
  scene.bundle.offset_sigma = offset_sigma;
  return scene;
}

// Of everything, landmarks eliminated.
Eigen::VectorXd gradientOf(BundleAdjustment bundle, const BundleOptions& options) {
  Eigen::MatrixXd vision_H, rest_H;
  Eigen::VectorXd vision_b, rest_b;
  bundle.linearize(&vision_H, &vision_b, &rest_H, &rest_b, options);
  return vision_b + rest_b;
}

TEST(BundleCalibration, KnowsWhatEachCameraHas) {
  const BundleCalibration estimated = threeCameraCalibration(), held = threeCameraCalibration(false);
  ASSERT_EQ(estimated.size(), 1 + CameraCorrection::kAll + 4);
  EXPECT_EQ(estimated.correction(0)->focalColumn(), 0);
  EXPECT_EQ(estimated.correction(1)->column, 1);
  EXPECT_EQ(estimated.correction(1)->focalColumn(), 4);
  EXPECT_EQ(estimated.correction(2)->focalColumn(), estimated.size() - 1);
  EXPECT_EQ(estimated.correction(3), nullptr);
  // A camera without a field has nothing to compare its focal length with.
  EXPECT_EQ(estimated.considered(), (std::vector<int>{0, estimated.size() - 1}));
  EXPECT_EQ(held.size(), estimated.size());
  EXPECT_EQ(static_cast<int>(held.considered().size()), held.size());
  EXPECT_EQ(BundleCalibration().size(), 0);
}

TEST(BundleCalibration, RetractedAndDifferenceToAreInverse) {
  Noise noise(1);
  const BundleCalibration exact = threeCameraCalibration();
  for (int i = 0; i < 100; ++i) {
    const BundleCalibration a = exact.retracted(calibrationNoise(exact, 0.4, &noise));
    const BundleCalibration b = exact.retracted(calibrationNoise(exact, 0.4, &noise));
    const Eigen::VectorXd d = calibrationNoise(exact, 0.2, &noise);
    EXPECT_LT((a.differenceTo(a.retracted(d)) - d).norm(), 1e-12);
    const BundleCalibration same = a.retracted(a.differenceTo(b));
    for (int k = 0; k < 3; ++k) {
      EXPECT_LT((same.correction(k)->R - b.correction(k)->R).norm(), 1e-12);
      EXPECT_NEAR(same.correction(k)->focal_length, b.correction(k)->focal_length, 1e-12);
      EXPECT_LT((same.correction(k)->field - b.correction(k)->field).norm(), 1e-12);
    }
    EXPECT_EQ(a.differenceTo(a).norm(), 0.0);
  }
}

TEST(BundleCalibration, RmsOfAFieldIsThatOfItsTermsOverTheImage) {
  FieldVector field = FieldVector::Zero();
  EXPECT_EQ(rmsOverImage(field), 0.0);
  field[1] = 2.0;  // st: the mean of s^2 t^2 is 1/9
  EXPECT_NEAR(rmsOverImage(field), 2.0 / 3.0, 0.01);
  field[1] = 0.0;
  field[0] = -1.0;  // s^2: the mean of s^4 is 1/5
  EXPECT_NEAR(rmsOverImage(field), std::sqrt(0.2), 0.01);
}

TEST(BundleAdjustmentCalibration, ErrorIsThatOfItsDefinition) {
  const BundleScene scene = calibratedScene(1, 0.3);
  for (const BundleLandmark& landmark : scene.bundle.landmarks) {
    for (const BundleObservation& view : landmark.observations) {
      Eigen::Vector2d error, by_distance, ahead, behind;
      ASSERT_TRUE(scene.bundle.error(landmark, view, &error, &by_distance));
      EXPECT_LT((error - errorOf(scene.bundle, landmark, view)).norm(), 1e-9);
      BundleLandmark nearer = landmark, farther = landmark;
      nearer.inverse_distance += 1e-6;
      farther.inverse_distance -= 1e-6;
      ASSERT_TRUE(scene.bundle.error(nearer, view, &ahead) && scene.bundle.error(farther, view, &behind));
      EXPECT_LT((by_distance - (ahead - behind) / 2e-6).norm(), 1e-4 * (1.0 + by_distance.norm()));
    }
  }
}

TEST(BundleAdjustmentCalibration, GradientIsThatOfTheCost) {
  BundleOptions options;
  options.inverse_distance_sigma = 0.1;
  options.robust_width = 4.0;  // at 2 forty iterations do not bring every landmark to its optimum
  for (unsigned seed = 1; seed <= 3; ++seed) {
    for (const double offset_sigma : {0.0, 0.3}) {
      // Landmarks and offsets at their conditional optimum, where the reduced gradient is that by the others alone.
      BundleAdjustment bundle = calibratedScene(seed, offset_sigma).bundle;
      const DenseBundle dense(bundle);
      for (int repetition = 0; repetition < 40; ++repetition) {
        Eigen::MatrixXd H;
        Eigen::VectorXd b;
        dense.linearize(bundle, options, &H, &b);
        for (std::size_t l = 0; l < bundle.landmarks.size(); ++l) {
          const int at = dense.firstOf(l), n = dense.unknownsOf(l);
          bundle = dense.retracted(bundle, at, symmetricSolve(H.block(at, at, n, n), b.segment(at, n)));
        }
      }
      const Eigen::VectorXd b = gradientOf(bundle, options);
      ASSERT_EQ(b.size(), dense.kept());
      const Eigen::VectorXd step = Eigen::VectorXd::Constant(1, 1e-6);
      for (int c = 0; c < dense.kept(); ++c) {
        const double ahead = costOf(dense.retracted(bundle, c, step), options);
        const double behind = costOf(dense.retracted(bundle, c, -step), options);
        EXPECT_NEAR(-b[c], (ahead - behind) / (2.0 * step[0]), 1e-4 * b.norm()) << "seed " << seed << " unknown " << c;
      }
      // Optimal offsets are not moved by a step of nothing.
      for (int c = dense.kept(); c < dense.size(); ++c) {
        const double ahead = costOf(dense.retracted(bundle, c, step), options);
        const double behind = costOf(dense.retracted(bundle, c, -step), options);
        EXPECT_NEAR(0.0, (ahead - behind) / (2.0 * step[0]), 1e-4 * b.norm()) << "seed " << seed << " unknown " << c;
      }
    }
  }
}

TEST(BundleAdjustmentCalibration, GradientOfThePriorIsThatOfTheCost) {
  const BundleOptions options;
  BundleScene scene = calibratedScene(3, 0.0);
  BundleAdjustment& bundle = scene.bundle;
  bundle.landmarks.clear();
  Noise noise(4);
  const int size = 12 + bundle.calibration.size();
  Eigen::MatrixXd A(size, size);
  for (int i = 0; i < size * size; ++i) A(i / size, i % size) = noise.gaussian();
  Eigen::VectorXd b(size);
  for (int i = 0; i < size; ++i) b[i] = 0.1 * noise.gaussian();
  setPrior(&scene, {0, 2}, A * A.transpose(), b);
  bundle.prior.calibration = threeCameraCalibration();
  const Eigen::VectorXd gradient = gradientOf(bundle, options);
  const DenseBundle dense(bundle);
  const Eigen::VectorXd step = Eigen::VectorXd::Constant(1, 1e-6);
  for (int c = 0; c < dense.kept(); ++c) {
    const double ahead = costOf(dense.retracted(bundle, c, step), options);
    const double behind = costOf(dense.retracted(bundle, c, -step), options);
    // The prior's Hessian is kept, so this holds to the order of the rotations from the linearization.
    EXPECT_NEAR(-gradient[c], (ahead - behind) / (2.0 * step[0]), 5e-3 * gradient.norm()) << "unknown " << c;
  }
}

TEST(BundleAdjustmentCalibration, NormalEquationsEqualTheDenseSchurComplement) {
  const BundleOptions options;
  for (unsigned seed = 1; seed <= 3; ++seed) {
    for (const double offset_sigma : {0.0, 0.05, 0.5}) {
      BundleScene scene = calibratedScene(seed, offset_sigma);
      const DenseBundle dense(scene.bundle);
      Eigen::MatrixXd H, reduced_H, vision_H, rest_H;
      Eigen::VectorXd b, reduced_b, vision_b, rest_b;
      dense.linearize(scene.bundle, options, &H, &b);
      eliminateLast(H, b, dense.kept(), &reduced_H, &reduced_b);
      scene.bundle.linearize(&vision_H, &vision_b, &rest_H, &rest_b, options);
      EXPECT_LT((vision_H - vision_H.transpose()).norm(), 1e-9 * vision_H.norm());
      // Poses and fields have other units.
      const Eigen::VectorXd sigmas = reduced_H.diagonal().cwiseSqrt().cwiseInverse();
      const Eigen::MatrixXd difference = sigmas.asDiagonal() * (vision_H - reduced_H) * sigmas.asDiagonal();
      EXPECT_LT(difference.cwiseAbs().maxCoeff(), 1e-4) << "seed " << seed << " offsets " << offset_sigma;
      const Eigen::VectorXd normalized = sigmas.cwiseProduct(reduced_b);
      EXPECT_LT((sigmas.cwiseProduct(vision_b) - normalized).norm(), 1e-4 * normalized.norm());
    }
  }
}

TEST(BundleAdjustmentCalibration, OneStepNearTheOptimumIsTheDenseOne) {
  // Of the landmarks and their offsets as well.
  BundleOptions options;
  options.max_iterations = 1;
  options.robust_width = 1e6;  // plain least squares
  BundleScene scene = calibratedScene(5, 0.3);
  const BundleAdjustment before = scene.bundle;
  const DenseBundle dense(before);
  Eigen::MatrixXd H;
  Eigen::VectorXd b;
  dense.linearize(before, options, &H, &b);
  // The first pose is the gauge; considered focal lengths stay.
  std::vector<int> held = before.calibration.considered();
  for (int& column : held) column += before.firstOfCalibration();
  for (int i = 0; i < 6; ++i) held.push_back(i);
  for (const int column : held) {
    H.row(column).setZero();
    H.col(column).setZero();
    H(column, column) = 1.0;
    b[column] = 0.0;
  }
  const BundleAdjustment expected = dense.retracted(before, 0, symmetricSolve(H, b));
  scene.bundle.solve(options);
  for (int i = 0; i < 3; ++i) {
    const Vector6d moved_by = localDifference(before.poses[i], expected.poses[i]);
    EXPECT_LT(localDifference(expected.poses[i], scene.bundle.poses[i]).norm(), 5e-3 * moved_by.norm() + 1e-12);
  }
  const Eigen::VectorXd corrected = before.calibration.differenceTo(expected.calibration);
  const Eigen::VectorXd error = expected.calibration.differenceTo(scene.bundle.calibration);
  EXPECT_LT(error.norm(), 5e-3 * corrected.norm());
  for (const int column : before.calibration.considered()) {
    EXPECT_EQ(before.calibration.differenceTo(scene.bundle.calibration)[column], 0.0);
  }
  for (std::size_t l = 0; l < before.landmarks.size(); ++l) {
    const BundleLandmark &one = scene.bundle.landmarks[l], &other = expected.landmarks[l];
    EXPECT_NEAR(one.inverse_distance, other.inverse_distance,
                5e-3 * std::abs(other.inverse_distance - before.landmarks[l].inverse_distance) + 1e-5);
    for (int k = 0; k < 3; ++k) {
      const double change = (other.offsets[k] - before.landmarks[l].offsets[k]).norm();
      EXPECT_LT((one.offsets[k] - other.offsets[k]).norm(), 5e-3 * change + 1e-3);
    }
  }
}

BundleCalibration stereoCalibration() {
  std::vector<CameraCorrection> cameras(2);
  cameras[1].turns = cameras[1].has_field = true;
  return BundleCalibration(cameras, true);
}

// Six poses that see all points exactly, with a second camera that is not as it is thought to be.
BundleScene exactScene(const BundleCalibration& truth, unsigned seed) {
  BundleScene scene = makeBundleScene(6, 80, stereoCenters(), 0.0, seed);
  scene.bundle.calibration = truth;
  for (BundleLandmark& landmark : scene.bundle.landmarks) {
    for (BundleObservation& view : landmark.observations) makeExact(scene.bundle, landmark, stereoCenters()[0], &view);
  }
  return scene;
}

TEST(BundleAdjustmentCalibration, FindsWhatIsWrongOfTheSecondCamera) {
  BundleOptions options;
  options.inverse_distance_sigma = 1e4;
  options.max_iterations = 200;
  options.relative_decrease = 1e-12;
  for (unsigned seed = 1; seed <= 5; ++seed) {
    Noise noise(seed);
    Eigen::VectorXd d = calibrationNoise(stereoCalibration(), 0.02, &noise);  // field of some 0.2 px a term
    const CameraCorrection second = *stereoCalibration().correction(1);
    d[0] = 0.0;
    d.segment<3>(second.column) = 0.5 * kDegree * Eigen::Vector3d(1.0, -1.0, 1.0);
    d[second.focalColumn()] = 0.003;
    const BundleCalibration truth = stereoCalibration().retracted(d);
    BundleScene scene = exactScene(truth, seed);
    ASSERT_LT(costOf(scene.bundle, options), 1e-6);
    scene.bundle.calibration = stereoCalibration();
    for (const double offset_sigma : {0.0, 0.25}) {
      scene.bundle.offset_sigma = offset_sigma;
      BundleAdjustment bundle = scene.bundle;
      EXPECT_TRUE(bundle.solve(options).finite);
      const Eigen::VectorXd error = truth.differenceTo(bundle.calibration);
      EXPECT_LT(error.segment<3>(second.column).norm(), 1e-3 * kDegree) << "seed " << seed;
      EXPECT_LT(std::abs(error[second.focalColumn()]), 1e-5) << "seed " << seed;
      EXPECT_LT(error.tail<kFieldTerms>().norm(), 0.01) << "seed " << seed;
      EXPECT_EQ(error[0], 0.0) << "the focal length of the first camera is considered";
      for (std::size_t i = 0; i < bundle.poses.size(); ++i) {
        EXPECT_LT(localDifference(scene.poses[i], bundle.poses[i]).norm(), 1e-3) << "seed " << seed;
      }
    }
  }
}

TEST(BundleAdjustmentCalibration, ConsideredParametersStay) {
  std::vector<CameraCorrection> cameras(2);
  cameras[1].turns = cameras[1].has_field = true;
  const BundleCalibration held(cameras, false);
  Eigen::VectorXd d = Eigen::VectorXd::Zero(held.size());
  d.segment<3>(held.correction(1)->column).setConstant(0.2 * kDegree);
  BundleScene scene = exactScene(held.retracted(d), 7);
  scene.bundle.calibration = held;
  const BundleSummary summary = scene.bundle.solve({});
  EXPECT_TRUE(summary.finite);
  EXPECT_EQ(held.differenceTo(scene.bundle.calibration).norm(), 0.0);
}

TEST(BundleAdjustmentCalibration, OffsetsTakeWhatAllViewsOfACameraHaveInCommon) {
  // Each point's patch looks a little different in the second camera, in all frames alike.
  BundleScene scene = makeBundleScene(6, 80, stereoCenters(), 0.0, 9);
  Noise noise(10);
  BundleAdjustment truth = scene.bundle;
  for (std::size_t l = 0; l < truth.landmarks.size(); ++l) {
    BundleLandmark& landmark = truth.landmarks[l];
    landmark.offsets[1] = {noise.gaussian(0.5), noise.gaussian(0.5)};
    for (BundleObservation& view : landmark.observations) makeExact(truth, landmark, stereoCenters()[0], &view);
    scene.bundle.landmarks[l].observations = landmark.observations;
  }
  BundleOptions options;
  options.inverse_distance_sigma = 1e4;
  BundleAdjustment with = scene.bundle, without = scene.bundle;
  with.offset_sigma = 0.5;
  const double cost_with = with.solve(options).cost, cost_without = without.solve(options).cost;
  EXPECT_LT(cost_with, 0.5 * cost_without);
  double across_error = 0.0;
  for (std::size_t l = 0; l < truth.landmarks.size(); ++l) {
    EXPECT_EQ(with.landmarks[l].offsets[0].norm(), 0.0) << "of the camera of the first view";
    EXPECT_EQ(without.landmarks[l].offsets[1].norm(), 0.0);
    across_error += std::pow((with.landmarks[l].offsets[1] - truth.landmarks[l].offsets[1]).norm(), 2) / 80.0;
  }
  EXPECT_LT(std::sqrt(across_error), 0.4);  // 0.71 if they were not found
}

}  // namespace
}  // namespace multicam_egomotion
