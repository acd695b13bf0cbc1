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
    const BundlePrior prior = marginalizeFirstPoses(1, &one.bundle, options);
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
  const BundlePrior prior = marginalizeFirstPoses(1, &leaving, options);
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
  computeMarginals(&one.bundle, options, 1.0, 0.0, {}, &estimate);
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
  computeMarginals(&one.bundle, options, 1.0, 0.0, {}, &all);
  computeMarginals(&one.bundle, options, 0.25, 0.0, {}, &quarter);
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
  computeMarginals(&honest.bundle, options, 1.0, 0.0, {}, &one);
  computeMarginals(&misled.bundle, options, 1.0, 0.0, {}, &other);
  const double moved = logSO3(one.relative.T_a_b.linear().transpose() * other.relative.T_a_b.linear()).norm();
  const double vision_moved = logSO3(one.vision.T_a_b.linear().transpose() * other.vision.T_a_b.linear()).norm();
  EXPECT_GT(moved, 3e-4);
  EXPECT_LT(vision_moved, 0.05 * moved);
}

TEST(WindowMarginals, OneCameraSeesNoScaleAndTwoDo) {
  const BundleOptions options;
  BundleScene mono = scene({{0.0, 0.0, 0.0}}, 4), stereo = scene(stereoCenters(), 4);
  WindowEstimate estimate;
  computeMarginals(&mono.bundle, options, 1.0, 0.0, {}, &estimate);
  EXPECT_EQ(estimate.scale_state, ScaleState::kUnobservable) << estimate.scale_sigma;
  computeMarginals(&stereo.bundle, options, 1.0, 0.0, {}, &estimate);
  EXPECT_EQ(estimate.scale_state, ScaleState::kObservable) << estimate.scale_sigma;
}

TEST(WindowMarginals, ScaleIsNotTakenFromVelocity) {
  const BundleOptions options;
  BundleScene mono = scene({{0.0, 0.0, 0.0}}, 4, 1e-4);  // the displacement is known to 0.1 mm
  WindowEstimate estimate;
  computeMarginals(&mono.bundle, options, 1.0, 0.0, {}, &estimate);
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
  computeMarginals(&bundle, options, 1.0, 0.0, {}, &estimate);
  EXPECT_EQ(estimate.scale_state, ScaleState::kNotApplicable);
}

TEST(WindowMarginals, CovariancesArePositiveDefiniteWhateverIsSeen) {
  const BundleOptions options;
  for (const auto& centers : {std::vector<Eigen::Vector3d>{{0.0, 0.0, 0.0}}, stereoCenters()}) {
    for (double translation_sigma : {0.0, 0.1}) {
      BundleScene one = scene(centers, 9, translation_sigma);
      for (BundleLandmark& landmark : one.bundle.landmarks) landmark.inverse_distance = 0.0;
      WindowEstimate estimate;
      computeMarginals(&one.bundle, options, 1.0, 0.0, {}, &estimate);
      for (const Matrix6d& covariance :
           {estimate.covariance, estimate.relative.covariance, estimate.vision.covariance}) {
        EXPECT_GT(symmetricEigenvalues(covariance)[0], 0.0);
        EXPECT_TRUE(covariance.allFinite());
      }
      EXPECT_FALSE(std::isnan(estimate.scale_sigma));
    }
  }
}

TEST(WindowMarginals, EliminatingPosesOneByOneKeepsWhatIsKnownOfTheCalibration) {
  const BundleOptions options;
  for (unsigned seed = 1; seed <= 3; ++seed) {
    BundleScene all = makeBundleScene(5, 80, threeCenters(), 0.4, seed);
    Noise noise(seed + 20);
    const BundleCalibration exact = threeCameraCalibration();
    all.bundle.calibration = exact.retracted(calibrationNoise(exact, 0.001, &noise));
    all.bundle.offset_sigma = 0.3;
    addMotionFactors(&all, 0.002, 0.05);
    // Landmark l is seen from pose l % 4 on, and leaves with it.
    for (int l = 0; l < 80; ++l) {
      std::vector<BundleObservation>& views = all.bundle.landmarks[l].observations;
      views.erase(views.begin(), views.begin() + 3 * (l % 4));
      for (BundleObservation& view : views) placeInImage(threeCenters()[0], &view);
    }
    const int size = 6 + exact.size();
    Eigen::MatrixXd H = Eigen::MatrixXd::Identity(size, size);
    H.topLeftCorner<6, 6>() *= 1e5;
    setPrior(&all, {0}, H, Eigen::VectorXd::Ones(size));
    all.bundle.prior.calibration = exact;

    BundleAdjustment at_once = all.bundle, rest = all.bundle;
    const BundlePrior expected = marginalizeFirstPoses(4, &at_once, options);
    for (int gone = 0; gone < 4; ++gone) {
      BundleAdjustment leaving = rest;
      leaving.landmarks.clear();
      for (int l = gone; l < 80; l += 4) {
        leaving.landmarks.push_back(all.bundle.landmarks[l]);
        for (BundleObservation& view : leaving.landmarks.back().observations) view.pose -= gone;
      }
      leaving.factors.resize(1);
      rest.prior = marginalizeFirstPoses(1, &leaving, options);
      for (int& pose : rest.prior.poses) --pose;
      rest.poses.erase(rest.poses.begin());
      rest.factors.erase(rest.factors.begin());
      for (MotionFactor& factor : rest.factors) {
        --factor.pose_a;
        --factor.pose_b;
      }
    }
    ASSERT_EQ(rest.prior.H.rows(), size);
    EXPECT_LT((rest.prior.H - expected.H).norm(), 1e-6 * expected.H.norm());
    const int unknowns = exact.size();
    const Eigen::MatrixXd H_calibration = expected.H.bottomRightCorner(unknowns, unknowns);
    EXPECT_LT((rest.prior.H.bottomRightCorner(unknowns, unknowns) - H_calibration).norm(), 1e-6 * H_calibration.norm());
    EXPECT_LT((rest.prior.b - expected.b).norm(), 1e-6 * expected.b.norm());
    EXPECT_EQ(rest.prior.calibration.differenceTo(all.bundle.calibration).norm(), 0.0);
    for (const int column : exact.considered()) {
      EXPECT_EQ(rest.prior.H(6 + column, 6 + column), 0.0);
      EXPECT_EQ(rest.prior.b[6 + column], 0.0);
    }
  }
}

/// A camera of unknown focal length that goes its way with a gyroscope and a velocity. Three poses are kept, a landmark
/// lives as long; what leaves becomes the prior.
class SlidingWindow {
 public:
  SlidingWindow(double focal_sigma, unsigned seed) : focal_sigma_(focal_sigma), noise_(seed) {
    const BundleCalibration thought({CameraCorrection()}, true);
    truth_.calibration = thought.retracted(Eigen::VectorXd::Constant(1, noise_.gaussian(focal_sigma)));
    options_.robust_width = 1e3;
    options_.relative_decrease = 1e-6;
    bundle_.calibration = thought;
    bundle_.pixel_sigma = kPixelSigma;
    bundle_.prior.poses = {0};
    bundle_.prior.linearization = {BundlePose()};
    bundle_.prior.calibration = thought;
    bundle_.prior.H = Eigen::MatrixXd::Zero(7, 7);
    bundle_.prior.H.diagonal().head<6>().setConstant(1e8);
    bundle_.prior.b = Eigen::VectorXd::Zero(7);
    addPose();
    addPose();
    addPose();
    bundle_.solve(options_);
  }

  void advance() {
    BundleAdjustment leaving = bundle_;
    leaving.landmarks.resize(kBorn);
    leaving.factors.resize(1);
    bundle_.prior = marginalizeFirstPoses(1, &leaving, options_);
    for (BundleAdjustment* bundle : {&truth_, &bundle_}) {
      bundle->poses.erase(bundle->poses.begin());
      bundle->landmarks.erase(bundle->landmarks.begin(), bundle->landmarks.begin() + kBorn);
      for (BundleLandmark& landmark : bundle->landmarks) {
        for (BundleObservation& view : landmark.observations) --view.pose;
      }
    }
    for (int& pose : bundle_.prior.poses) --pose;
    bundle_.factors.erase(bundle_.factors.begin());
    --bundle_.factors[0].pose_a;
    --bundle_.factors[0].pose_b;
    addPose();
    bundle_.solve(options_);
  }

  WindowEstimate estimate(bool consider) {
    WindowEstimate estimate;
    const double variance = consider ? focal_sigma_ * focal_sigma_ : 0.0;
    computeMarginals(&bundle_, options_, 1.0, 0.0, Eigen::VectorXd::Constant(1, variance), &estimate);
    return estimate;
  }
  const BundlePrior& prior() const { return bundle_.prior; }

  /// Normalized squared errors per degree of freedom, of the newest pose and of the last motion.
  Eigen::Vector2d nees(bool consider) {
    const WindowEstimate now = estimate(consider);
    const auto isometry = [](const BundlePose& pose) { return relativeOf(BundlePose(), pose); };
    const Eigen::Matrix<double, 6, 1> pose = difference(isometry(bundle_.poses[2]), isometry(truth_.poses[2]));
    const Eigen::Matrix<double, 6, 1> motion =
        difference(now.relative.T_a_b, relativeOf(truth_.poses[1], truth_.poses[2]));
    return Eigen::Vector2d(squaredMahalanobis(pose, now.covariance),
                           squaredMahalanobis(motion, now.relative.covariance)) /
           6.0;
  }

 private:
  static constexpr int kBorn = 15;
  static constexpr double kPixelSigma = 0.2, kRotationSigma = 0.004, kPositionSigma = 0.02;

  void addPose() {
    const int newest = static_cast<int>(truth_.poses.size());
    BundlePose pose, guess;
    if (newest > 0) {
      const BundlePose& before = truth_.poses.back();
      const double t = 0.3 * count_++;
      pose.R = before.R * expSO3({0.06 * std::sin(t), 0.05 * std::cos(0.7 * t), 0.08 * std::sin(0.4 * t)});
      pose.p = before.p + before.R * Eigen::Vector3d(0.25, 0.05 * std::sin(t), 0.0);
      MotionFactor factor;
      factor.pose_a = newest - 1;
      factor.pose_b = newest;
      factor.R_a_b = before.R.transpose() * pose.R * expSO3(noise_.vector(kRotationSigma));
      factor.p_b_a = before.R.transpose() * (pose.p - before.p) + noise_.vector(kPositionSigma);
      factor.rotation_information = Eigen::Matrix3d::Identity() / (kRotationSigma * kRotationSigma);
      factor.translation_information = Eigen::Matrix3d::Identity() / (kPositionSigma * kPositionSigma);
      bundle_.factors.push_back(factor);
      const BundlePose& last = bundle_.poses.back();
      guess.R = last.R * factor.R_a_b;
      guess.p = last.p + last.R * factor.p_b_a;
    }
    truth_.poses.push_back(pose);
    bundle_.poses.push_back(guess);
    for (int i = 0; i < kBorn; ++i) {
      const double x = noise_.uniform(3.0, 12.0);
      const Eigen::Vector3d point(x, x * noise_.uniform(-0.6, 0.6), x * noise_.uniform(-0.5, 0.5));
      BundleLandmark born;
      born.origin = pose.p;
      born.direction = pose.R * point.normalized();
      born.inverse_distance = 1.0 / point.norm();
      truth_.landmarks.push_back(born);
      born.origin = guess.p;
      born.direction = guess.R * point.normalized();
      bundle_.landmarks.push_back(born);
    }
    for (std::size_t l = 0; l < truth_.landmarks.size(); ++l) {
      const BundleLandmark& landmark = truth_.landmarks[l];
      const Eigen::Vector3d point = landmark.origin + landmark.direction / landmark.inverse_distance;
      BundleObservation view = observe(pose, newest, Eigen::Vector3d::Zero(), point, 0.0, &noise_);
      makeExact(truth_, landmark, Eigen::Vector3d::Zero(), &view);
      const Eigen::Vector2d error(noise_.gaussian(kPixelSigma), noise_.gaussian(kPixelSigma));
      view.bearing = (view.bearing + view.to_pixel.transpose() * error / (400.0 * 400.0)).normalized();
      view.to_pixel -= view.to_pixel * view.bearing * view.bearing.transpose();
      bundle_.landmarks[l].observations.push_back(view);
    }
  }

  double focal_sigma_;
  Noise noise_;
  BundleAdjustment truth_, bundle_;
  BundleOptions options_;
  int count_ = 0;
};

TEST(WindowMarginals, WhatIsConsideredIsNeverLearnt) {
  SlidingWindow window(0.01, 1);
  const double sigma = std::sqrt(window.estimate(true).relative.covariance.trace());
  for (int i = 0; i < 1000; ++i) window.advance();
  const WindowEstimate estimate = window.estimate(true);
  EXPECT_NEAR(estimate.calibration_covariance(0, 0), 1e-4, 1e-12);
  const int column = static_cast<int>(window.prior().b.size()) - 1;
  EXPECT_EQ(window.prior().H(column, column), 0.0);
  EXPECT_NEAR(std::sqrt(estimate.relative.covariance.trace()), sigma, 0.5 * sigma);
  EXPECT_GT(symmetricEigenvalues(estimate.covariance)[0], 0.0);
}

TEST(WindowMarginals, WhatIsConsideredIsInTheCovarianceOfThePoses) {
  for (const int steps : {0, 10}) {
    constexpr int kRuns = 100;
    Eigen::Vector2d with = Eigen::Vector2d::Zero(), without = Eigen::Vector2d::Zero();
    for (unsigned seed = 1; seed <= kRuns; ++seed) {
      SlidingWindow window(0.02, seed);
      for (int i = 0; i < steps; ++i) window.advance();
      with += window.nees(true) / kRuns;
      without += window.nees(false) / kRuns;
    }
    std::printf("after %2d steps: NEES/dof of pose %.2f (%.2f without), motion %.2f (%.2f without)\n", steps, with[0],
                without[0], with[1], without[1]);
    // 1 within three standard deviations of the mean of 100 of six degrees of freedom.
    for (int kind : {0, 1}) {
      EXPECT_NEAR(with[kind], 1.0, 0.2);
      EXPECT_GT(without[kind], 5.0);
    }
  }
}

}  // namespace
}  // namespace multicam_egomotion
