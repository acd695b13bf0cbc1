// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

#include "correspondence_scene.h"

namespace multicam_egomotion {
namespace {

const Eigen::Vector3d kRotation(0.02, -0.03, 0.08);
const Eigen::Vector3d kTranslation(-0.4, 0.1, 0.05);

std::vector<double> errorsOf(const CorrespondenceSet& set, const Eigen::Matrix3d& R, const Eigen::Vector3d& t) {
  std::vector<double> errors;
  set.squaredSampsonErrors(R, t, &errors);
  return errors;
}

// Squared distance [px^2] in both images from the observed directions to the nearest pair that meets: Gauss-Newton on
// the exact constraint (the optimal correction of both views).
double squaredReprojectionDistance(const CorrespondenceScene& scene, int index) {
  const CorrespondenceSet::Entry& entry = scene.entries[index];
  const Eigen::Vector3d baseline =
      scene.R * scene.centers[entry.rays.camera1] + scene.t - scene.centers[entry.rays.camera2];
  const Eigen::Matrix3d E = skew(baseline) * scene.R;
  const Eigen::Vector3d x1 = entry.rays.first.direction, x2 = entry.rays.second.direction;
  const Eigen::Vector3d u1 = x1.unitOrthogonal(), v1 = x1.cross(u1), u2 = x2.unitOrthogonal(), v2 = x2.cross(u2);
  const double f = CorrespondenceScene::kFocalLength;
  Eigen::Vector4d d = Eigen::Vector4d::Zero();  // correction in tangent pixels
  for (int i = 0; i < 20; ++i) {
    const Eigen::Vector3d y1 = x1 + (d[0] * u1 + d[1] * v1) / f, y2 = x2 + (d[2] * u2 + d[3] * v2) / f;
    const Eigen::Vector3d by1 = E.transpose() * y2, by2 = E * y1;
    const Eigen::Vector4d J = Eigen::Vector4d(by1.dot(u1), by1.dot(v1), by2.dot(u2), by2.dot(v2)) / f;
    const double e = y2.dot(E * y1);
    d = J * ((J.dot(d) - e) / J.squaredNorm());  // nearest point of the linearized constraint to d = 0
  }
  return d.squaredNorm();
}

TEST(CorrespondenceSet, SampsonErrorIsZeroAtTheTruth) {
  for (const RigShape& rig : {monoShape(), stereoShape(), surroundShape()}) {
    const CorrespondenceScene scene = makeCorrespondenceScene(rig, kRotation, kTranslation, 100, 0.0, 0.0, 1);
    for (double error : errorsOf(scene.set(), scene.R, scene.t)) EXPECT_LT(error, 1e-16);
  }
}

TEST(CorrespondenceSet, SampsonErrorIsTheReprojectionDistance) {
  for (const RigShape& rig : {monoShape(), stereoShape(), surroundShape()}) {
    const CorrespondenceScene scene = makeCorrespondenceScene(rig, kRotation, kTranslation, 150, 0.5, 0.0, 2);
    const CorrespondenceSet set = scene.set();
    const std::vector<double> errors = errorsOf(set, scene.R, scene.t);
    double sum = 0.0;
    for (int position = 0; position < set.size(); ++position) {
      const double exact = std::sqrt(squaredReprojectionDistance(scene, set.indexAt(position)));
      EXPECT_NEAR(std::sqrt(errors[position]), exact, 0.01 * exact + 1e-4);
      sum += errors[position] / set.size();
    }
    // One constraint on four numbers of noise: chi-square with one degree of freedom.
    EXPECT_NEAR(sum / 0.25, 1.0, 0.25);
  }
}

TEST(CorrespondenceSet, EachImageCountsByItsOwnScale) {
  CorrespondenceScene scene = makeCorrespondenceScene(monoShape(), kRotation, kTranslation, 50, 0.5, 0.0, 3);
  const std::vector<double> before = errorsOf(scene.set(), scene.R, scene.t);
  for (auto& entry : scene.entries) entry.pixels_per_radian1 = entry.pixels_per_radian2 = 800.0;
  const std::vector<double> twice = errorsOf(scene.set(), scene.R, scene.t);
  for (auto& entry : scene.entries) entry.pixels_per_radian1 = 400.0;
  const std::vector<double> mixed = errorsOf(scene.set(), scene.R, scene.t);
  for (std::size_t i = 0; i < before.size(); ++i) {
    EXPECT_NEAR(twice[i], 4.0 * before[i], 1e-9 * before[i]);
    EXPECT_GT(mixed[i], before[i]);
    EXPECT_LT(mixed[i], twice[i]);
  }
}

TEST(CorrespondenceSet, GroupsByCameraPairAndFindsBack) {
  const CorrespondenceScene scene = makeCorrespondenceScene(stereoShape(), kRotation, kTranslation, 80, 0.5, 0.3, 4);
  const CorrespondenceSet set = scene.set();
  ASSERT_EQ(set.size(), static_cast<int>(scene.entries.size()));
  ASSERT_EQ(set.cameraPairs().size(), 4u);
  std::set<std::pair<int, int>> pairs;
  std::set<int> indices;
  int next = 0;
  for (std::size_t p = 0; p < set.cameraPairs().size(); ++p) {
    const CorrespondenceSet::CameraPair& pair = set.cameraPairs()[p];
    EXPECT_TRUE(pairs.insert({pair.camera1, pair.camera2}).second);
    EXPECT_EQ(pair.begin, next);
    next = pair.end;
    for (int position = pair.begin; position < pair.end; ++position) {
      const int index = set.indexAt(position);
      EXPECT_TRUE(indices.insert(index).second);
      EXPECT_EQ(set.rays(index).camera1, pair.camera1);
      EXPECT_EQ(set.rays(index).camera2, pair.camera2);
      EXPECT_EQ(set.pairOf(index), static_cast<int>(p));
      EXPECT_EQ(set.rays(index).second.direction, scene.entries[index].rays.second.direction);
    }
  }
  EXPECT_EQ(next, set.size());
}

TEST(CorrespondenceSet, ScoreIsTheTruncatedSumAndStopsEarly) {
  const CorrespondenceScene scene = makeCorrespondenceScene(surroundShape(), kRotation, kTranslation, 200, 0.5, 0.3, 5);
  const CorrespondenceSet set = scene.set();
  const std::vector<double> errors = errorsOf(set, scene.R, scene.t);
  double expected = 0.0;
  for (double error : errors) expected += std::min(error, 4.0);
  std::vector<double> buffer;
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_NEAR(set.score(scene.R, scene.t, 4.0, infinity, &buffer), expected, 1e-9);
  EXPECT_NEAR(set.score(scene.R, scene.t, 4.0, expected * 1.001, &buffer), expected, 1e-9);
  const double stopped = set.score(scene.R, scene.t, 4.0, 0.1 * expected, &buffer);
  EXPECT_GT(stopped, 0.1 * expected);
  EXPECT_LT(stopped, 0.9 * expected);
}

TEST(CorrespondenceSet, WithoutBaselineNothingIsKnownAndNothingIsNaN) {
  const CorrespondenceScene scene =
      makeCorrespondenceScene(monoShape(), Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(), 30, 0.5, 0.0, 6);
  for (double error : errorsOf(scene.set(), scene.R, scene.t)) EXPECT_TRUE(std::isfinite(error));
  const CorrespondenceSet empty({}, scene.centers, scene.centers);
  std::vector<double> buffer;
  EXPECT_EQ(empty.size(), 0);
  EXPECT_EQ(empty.score(scene.R, scene.t, 4.0, 1.0, &buffer), 0.0);
}

}  // namespace
}  // namespace multicam_egomotion
