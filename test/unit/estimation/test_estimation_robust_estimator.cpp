// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "correspondence_scene.h"
#include "multicam_egomotion/estimation/minimal_solvers.h"
#include "multicam_egomotion/estimation/robust_estimator.h"

namespace multicam_egomotion {
namespace {

using Vertical = FourPointVertical;
using Axis = FourPointAxis;

VerticalPrior verticalOf(const CorrespondenceScene& scene, const Eigen::Vector3d& tilt_error) {
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  return verticalPriorFromUp(up, expSO3(tilt_error) * scene.R * up);
}

double rotationError(const RobustEstimate& found, const CorrespondenceScene& scene) {
  return logSO3(found.R * scene.R.transpose()).norm();
}

double directionError(const RobustEstimate& found, const CorrespondenceScene& scene) {
  const Eigen::Vector3d& center = scene.centers[0];
  const Eigen::Vector3d truth = scene.R * center + scene.t - center, seen = found.R * center + found.t - center;
  return std::acos(std::min(1.0, seen.normalized().dot(truth.normalized())));
}

struct Case {
  const char* name;
  RigShape rig;
};

// Rigs of which a minimal sample determines the pose; samples of one camera pair do not.
std::vector<Case> cases() { return {{"stereo", stereoShape()}, {"surround", surroundShape()}}; }

TEST(RobustEstimator, SucceedsWithOutliers) {
  RobustEstimatorOptions options;
  for (const Case& one : cases()) {
    for (double outliers : {0.0, 0.3, 0.6}) {
      int good = 0;
      const int runs = 25;
      for (unsigned seed = 1; seed <= runs; ++seed) {
        const CorrespondenceScene scene =
            makeCorrespondenceScene(one.rig, kRotation, kTranslation, 200, 0.4, outliers, seed);
        // A vertical that is 0.2 deg wrong.
        const RobustEstimate found =
            estimate<Vertical>(scene.set(), verticalOf(scene, {0.0035, 0.0, 0.0}), {}, options, seed);
        good += found.success && rotationError(found, scene) < 0.01 && directionError(found, scene) < 0.2;
        EXPECT_LE(found.samples, options.max_samples);
        EXPECT_GE(found.samples, options.min_samples);
      }
      EXPECT_GE(good, outliers < 0.5 ? runs - 1 : runs - 5) << one.name << " with " << outliers << " outliers";
    }
  }
}

TEST(RobustEstimator, InliersAreTheTrueOnes) {
  const CorrespondenceScene scene = makeCorrespondenceScene(stereoShape(), kRotation, kTranslation, 200, 0.4, 0.4, 7);
  const CorrespondenceSet set = scene.set();
  const RobustEstimate found = estimate<Vertical>(set, verticalOf(scene, Eigen::Vector3d::Zero()), {}, {}, 1);
  ASSERT_TRUE(found.success);
  ASSERT_EQ(found.inliers.size(), scene.entries.size());
  int missed = 0, wrong = 0, inliers = 0, true_inliers = 0;
  for (std::size_t i = 0; i < scene.entries.size(); ++i) {
    inliers += found.inliers[i];
    true_inliers += !scene.outlier[i];
    missed += !scene.outlier[i] && !found.inliers[i];
    wrong += scene.outlier[i] && found.inliers[i];
  }
  EXPECT_EQ(inliers, found.inlier_count);
  EXPECT_LT(missed, 0.02 * true_inliers);
  EXPECT_LT(wrong, 0.05 * true_inliers);  // those that lie on the epipolar line by chance
}

// Without motion nothing tells how far the body has moved along the stereo baseline, but all points lie in front.
TEST(RobustEstimator, RestLosesNoInliers) {
  for (unsigned seed = 1; seed <= 200; ++seed) {
    const Eigen::Vector3d tremble(2e-5, -1e-5, 1e-5);
    CorrespondenceScene scene = makeCorrespondenceScene(stereoShape(), tremble, tremble, 300, 0.1, 0.0, seed);
    // From frame to frame a patch keeps its error; between the cameras it does not.
    std::mt19937 random(seed);
    std::normal_distribution<double> change(0.0, 2e-5);
    for (CorrespondenceSet::Entry& entry : scene.entries) {
      if (entry.rays.camera1 != entry.rays.camera2) continue;
      const Eigen::Vector3d changed(change(random), change(random), change(random));
      entry.rays.second =
          makeRay((scene.R * entry.rays.first.direction + changed).normalized(), scene.centers[entry.rays.camera2]);
    }
    MotionPriors prior;
    prior.rotation = {scene.R, Eigen::Matrix3d::Identity() / (5e-4 * 5e-4)};
    const RobustEstimate found =
        estimate<Vertical>(scene.set(), verticalOf(scene, Eigen::Vector3d::Zero()), prior, {}, seed);
    EXPECT_TRUE(found.success && found.covariance.allFinite()) << seed;
    EXPECT_GT(found.inlier_count, 0.9 * scene.entries.size()) << seed;
  }
}

TEST(RobustEstimator, MetricScaleComesWithOverlap) {
  int good = 0;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const CorrespondenceScene scene =
        makeCorrespondenceScene(stereoShape(), kRotation, kTranslation, 200, 0.3, 0.2, seed);
    const RobustEstimate found =
        estimate<Vertical>(scene.set(), verticalOf(scene, Eigen::Vector3d::Zero()), {}, {}, seed);
    good += std::abs(found.t.norm() / scene.t.norm() - 1.0) < 0.1;
  }
  EXPECT_GE(good, 18);
}

TEST(RobustEstimator, AxisSolverWithTheGyroscopesRotation) {
  for (const Case& one : cases()) {
    int good = 0;
    for (unsigned seed = 1; seed <= 20; ++seed) {
      const CorrespondenceScene scene =
          makeCorrespondenceScene(one.rig, {0.02, -0.04, 0.12}, kTranslation, 200, 0.4, 0.3, seed);
      const Eigen::Matrix3d R_gyro = expSO3(Eigen::Vector3d(3e-4, -4e-4, 2e-4)) * scene.R;
      MotionPriors prior;
      prior.rotation = {R_gyro, Eigen::Matrix3d::Identity() / (5e-4 * 5e-4)};
      const RobustEstimate found = estimate<Axis>(scene.set(), {logSO3(R_gyro)}, prior, {}, seed);
      good += found.success && rotationError(found, scene) < 2e-3 && directionError(found, scene) < 0.15;
    }
    EXPECT_GE(good, 19) << one.name;
  }
}

TEST(RobustEstimator, FivePointSolverWithTheGyroscopesAngle) {
  int good = 0;
  const int runs = 3;
  for (unsigned seed = 1; seed <= runs; ++seed) {
    const CorrespondenceScene scene =
        makeCorrespondenceScene(stereoShape(), kRotation, kTranslation, 200, 0.4, 0.3, seed);
    const RobustEstimate found =
        estimate<FivePointMartyushev>(scene.set(), {kRotation.norm() + 1e-4}, {}, RobustEstimatorOptions(), seed);
    good += found.success && rotationError(found, scene) < 0.01 && directionError(found, scene) < 0.2;
  }
  EXPECT_EQ(good, runs);
}

TEST(RobustEstimator, TheRotationPriorDropsHypothesesBeforeTheyAreScored) {
  const CorrespondenceScene scene =
      makeCorrespondenceScene(surroundShape(), kRotation, kTranslation, 200, 0.4, 0.6, 11);
  const CorrespondenceSet set = scene.set();
  const VerticalPrior vertical = verticalOf(scene, Eigen::Vector3d::Zero());
  MotionPriors prior;
  prior.rotation = {scene.R, Eigen::Matrix3d::Identity() / (5e-3 * 5e-3)};
  RobustEstimatorOptions options;
  options.min_samples = options.max_samples = 2000;
  const RobustEstimate with = estimate<Vertical>(set, vertical, prior, options, 1);
  const RobustEstimate without = estimate<Vertical>(set, vertical, {}, options, 1);
  ASSERT_TRUE(with.success);
  EXPECT_LT(with.models, 0.8 * without.models);
  // A prior that contradicts the images leaves nothing.
  MotionPriors wrong;
  wrong.rotation = {expSO3(Eigen::Vector3d(0.0, 0.0, 0.5)) * scene.R, prior.rotation.information};
  const RobustEstimate none = estimate<Vertical>(set, vertical, wrong, {}, 1);
  EXPECT_TRUE(!none.success || logSO3(none.R * wrong.rotation.R.transpose()).norm() < 0.05);
}

TEST(RobustEstimator, IsDeterministicBySeed) {
  const CorrespondenceScene scene = makeCorrespondenceScene(stereoShape(), kRotation, kTranslation, 150, 0.5, 0.5, 3);
  const CorrespondenceSet set = scene.set();
  const VerticalPrior vertical = verticalOf(scene, {0.002, 0.001, 0.0});
  const RobustEstimate one = estimate<Vertical>(set, vertical, {}, {}, 9),
                       same = estimate<Vertical>(set, vertical, {}, {}, 9);
  EXPECT_EQ(one.R, same.R);
  EXPECT_EQ(one.t, same.t);
  EXPECT_EQ(one.inliers, same.inliers);
  EXPECT_EQ(one.samples, same.samples);
}

TEST(RobustEstimator, TooFewCorrespondencesAreAFailure) {
  for (int count : {0, 2, 4, 7}) {
    const CorrespondenceScene scene = makeCorrespondenceScene(monoShape(), kRotation, kTranslation, count, 0.2, 0.0, 1);
    const RobustEstimate found = estimate<Vertical>(scene.set(), verticalOf(scene, Eigen::Vector3d::Zero()), {}, {}, 1);
    EXPECT_FALSE(found.success) << count;
    EXPECT_EQ(found.inliers.size(), scene.entries.size());
    EXPECT_EQ(found.inlier_count, 0);
  }
}

TEST(RobustEstimator, OutliersAloneGiveNoConfidentAnswer) {
  int confident = 0;
  for (unsigned seed = 1; seed <= 10; ++seed) {
    const CorrespondenceScene scene =
        makeCorrespondenceScene(stereoShape(), kRotation, kTranslation, 100, 0.5, 1.0, seed);
    const RobustEstimate found =
        estimate<Vertical>(scene.set(), verticalOf(scene, Eigen::Vector3d::Zero()), {}, {}, seed);
    EXPECT_TRUE(found.R.allFinite() && found.t.allFinite());
    confident += found.inlier_count > 0.3 * scene.entries.size();
  }
  EXPECT_EQ(confident, 0);
}

TEST(RobustEstimator, FewSamplesSufficeWithoutOutliers) {
  const RobustEstimatorOptions options;
  const CorrespondenceScene scene = makeCorrespondenceScene(stereoShape(), kRotation, kTranslation, 200, 0.3, 0.0, 2);
  const RobustEstimate found =
      estimate<Vertical>(scene.set(), verticalOf(scene, Eigen::Vector3d::Zero()), {}, options, 1);
  ASSERT_TRUE(found.success);
  EXPECT_LE(found.samples, 2 * options.min_samples);
}

TEST(RobustEstimator, EveryScoreAndSamplingSucceeds) {
  for (const Score score : {Score::kMsac, Score::kMarginalizing}) {
    for (const Sampling sampling : {Sampling::kUniform, Sampling::kProsac, Sampling::kRigAware}) {
      RobustEstimatorOptions options;
      options.score = score;
      options.sampling = sampling;
      int good = 0;
      for (unsigned seed = 1; seed <= 10; ++seed) {
        CorrespondenceScene scene =
            makeCorrespondenceScene(surroundShape(), kRotation, kTranslation, 200, 0.4, 0.4, seed);
        for (std::size_t i = 0; i < scene.entries.size(); ++i) scene.entries[i].quality = !scene.outlier[i];
        const RobustEstimate found =
            estimate<Vertical>(scene.set(), verticalOf(scene, Eigen::Vector3d::Zero()), {}, options, seed);
        good += found.success && rotationError(found, scene) < 0.005 && directionError(found, scene) < 0.1;
      }
      EXPECT_GE(good, 9) << static_cast<int>(score) << " " << static_cast<int>(sampling);
    }
  }
}

TEST(RobustEstimator, ProsacNeedsFewerSamplesWhereTheQualityTells) {
  CorrespondenceScene scene = makeCorrespondenceScene(surroundShape(), kRotation, kTranslation, 200, 0.4, 0.6, 2);
  for (std::size_t i = 0; i < scene.entries.size(); ++i) scene.entries[i].quality = !scene.outlier[i];
  const CorrespondenceSet set = scene.set();
  RobustEstimatorOptions options;
  options.min_samples = options.max_samples = 10;
  options.sampling = Sampling::kProsac;
  const RobustEstimate found = estimate<Vertical>(set, verticalOf(scene, Eigen::Vector3d::Zero()), {}, options, 1);
  ASSERT_TRUE(found.success);
  EXPECT_LT(rotationError(found, scene), 0.005);
}

// The smallest plug-in: it knows the answer, and how it was called.
struct KnownPose {
  static constexpr int kSampleSize = 2;
  struct Prior {
    RelativePose pose;
    Eigen::Vector3d center;
  };
  static std::vector<RelativePose> solve(const std::array<RayCorrespondence, 2>&, const Prior& prior,
                                         const SolverOptions& options) {
    EXPECT_TRUE(options.positive_depths_only);
    EXPECT_EQ(options.camera_count, 2);
    EXPECT_EQ(options.camera_centers[1], prior.center);
    return {prior.pose, {prior.pose.R, -prior.pose.t, true}};
  }
};

TEST(RobustEstimator, TakesAnySolverAndPlainRansacKeepsItsModel) {
  const CorrespondenceScene scene = makeCorrespondenceScene(stereoShape(), kRotation, kTranslation, 100, 0.3, 0.3, 4);
  const CorrespondenceSet set = scene.set();
  RobustEstimatorOptions options;
  options.local_optimization = options.final_refinement = false;
  const RobustEstimate found = estimate<KnownPose>(set, {{scene.R, scene.t, true}, scene.centers[1]}, {}, options, 1);
  ASSERT_TRUE(found.success);
  EXPECT_EQ(found.R, scene.R);
  EXPECT_EQ(found.t, scene.t);
  EXPECT_EQ(found.refinements, 0);
  EXPECT_LE(found.models, 2 * found.samples);
}

}  // namespace
}  // namespace multicam_egomotion
