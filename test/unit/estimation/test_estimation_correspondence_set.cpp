// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <vector>

#include "correspondence_scene.h"

namespace multicam_egomotion {
namespace {

constexpr double kLimit = 1000.0;  // [px], behind a camera

std::vector<double> errorsOf(const CorrespondenceSet& set, const Eigen::Matrix3d& R, const Eigen::Vector3d& t) {
  CorrespondenceSet::Residuals residuals;
  set.evaluate(R, t, kLimit, &residuals);
  return residuals.errors;
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
    for (double error : errorsOf(scene.set(), scene.R, scene.t)) EXPECT_LT(error, 1e-8);
  }
}

TEST(CorrespondenceSet, SampsonErrorIsTheReprojectionDistance) {
  for (const RigShape& rig : {monoShape(), stereoShape(), surroundShape()}) {
    const CorrespondenceScene scene = makeCorrespondenceScene(rig, kRotation, kTranslation, 150, 0.5, 0.0, 2);
    const CorrespondenceSet set = scene.set();
    const std::vector<double> errors = errorsOf(set, scene.R, scene.t);
    double sum = 0.0;
    for (int i = 0; i < set.size(); ++i) {
      const double exact = std::sqrt(squaredReprojectionDistance(scene, i));
      EXPECT_NEAR(errors[i], exact, 0.01 * exact + 1e-4);
      sum += errors[i] * errors[i] / set.size();
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
    EXPECT_NEAR(twice[i], 2.0 * before[i], 1e-9 * before[i]);
    EXPECT_GT(mixed[i], before[i]);
    EXPECT_LT(mixed[i], twice[i]);
  }
}

TEST(CorrespondenceSet, GroupsByCameraPair) {
  const CorrespondenceScene scene = makeCorrespondenceScene(stereoShape(), kRotation, kTranslation, 80, 0.5, 0.3, 4);
  const CorrespondenceSet set = scene.set();
  ASSERT_EQ(set.size(), static_cast<int>(scene.entries.size()));
  ASSERT_EQ(set.cameraPairs().size(), 4u);
  std::vector<int> sizes(4, 0);
  for (int i = 0; i < set.size(); ++i) {
    const CorrespondenceSet::CameraPair& pair = set.cameraPairs()[set.pairOf(i)];
    EXPECT_EQ(set.rays(i).camera1, pair.camera1);
    EXPECT_EQ(set.rays(i).camera2, pair.camera2);
    EXPECT_EQ(set.rays(i).second.direction, scene.entries[i].rays.second.direction);
    ++sizes[set.pairOf(i)];
  }
  for (int p = 0; p < 4; ++p) EXPECT_EQ(sizes[p], set.cameraPairs()[p].size);
}

double lossOf(const std::vector<double>& errors, const RobustLoss& loss) {
  double sum = 0.0;
  for (double error : errors) sum += loss.value(error);
  return sum;
}

TEST(CorrespondenceSet, LossesAreThoseOfTheErrors) {
  using Part = CorrespondenceSet::Part;
  const CorrespondenceScene scene = makeCorrespondenceScene(surroundShape(), kRotation, kTranslation, 333, 0.5, 0.3, 5);
  const CorrespondenceSet set = scene.set();
  for (const RobustLoss& loss : {RobustLoss{2.0, 2.0}, RobustLoss{0.5, 2.0}, RobustLoss{1.0, 1.5}}) {
    CorrespondenceSet::Residuals residuals;
    set.evaluate(scene.R, scene.t, loss.limit, &residuals);
    const double expected = lossOf(residuals.errors, loss);
    const double all = set.sumOfLosses(scene.R, scene.t, loss, Part::kAll);
    EXPECT_NEAR(all, expected, 1e-3);
    const double probe = set.sumOfLosses(scene.R, scene.t, loss, Part::kProbe);
    EXPECT_NEAR(probe + set.sumOfLosses(scene.R, scene.t, loss, Part::kRest), all, 1e-3);
    // The probe is a fair sample.
    EXPECT_NEAR(probe / set.partSize(Part::kProbe), all / set.size(), 0.15);
  }
  EXPECT_NEAR(set.partSize(Part::kProbe), CorrespondenceSet::kProbe, 8 * 4);
  EXPECT_EQ(set.partSize(Part::kProbe) + set.partSize(Part::kRest), set.size());
}

TEST(CorrespondenceSet, APointBehindTheCamerasIsAnOutlier) {
  const CorrespondenceScene scene = makeCorrespondenceScene(monoShape(), kRotation, kTranslation, 60, 0.0, 0.0, 6);
  const CorrespondenceSet set = scene.set();
  // The opposite baseline fits every epipolar line, with the points behind.
  const Eigen::Vector3d& center = scene.centers[0];
  const Eigen::Vector3d opposite = -(scene.R * center + scene.t - center) - scene.R * center + center;
  CorrespondenceSet::Residuals ahead, behind;
  set.evaluate(scene.R, scene.t, 1.0, &ahead);
  set.evaluate(scene.R, opposite, 1.0, &behind);
  int outliers = 0;
  for (int i = 0; i < set.size(); ++i) {
    EXPECT_LT(ahead.errors[i], 1e-8);
    outliers += std::isinf(behind.errors[i]);
  }
  EXPECT_GT(outliers, 0.8 * set.size());
}

TEST(CorrespondenceSet, NearnessIsTheInverseDistanceAndLeverageIsPerBaseline) {
  const CorrespondenceScene scene = makeCorrespondenceScene(stereoShape(), kRotation, kTranslation, 60, 0.0, 0.0, 7);
  const CorrespondenceSet set = scene.set();
  CorrespondenceSet::Residuals residuals;
  set.evaluate(scene.R, scene.t, 1.0, &residuals);
  double unit = 0.0;
  for (const auto& pair : set.cameraPairs()) {
    unit += (scene.R * pair.center1 + scene.t - pair.center2).norm() / set.cameraPairs().size();
  }
  for (int i = 0; i < set.size(); ++i) {
    const RayCorrespondence& rays = set.rays(i);
    const Eigen::Vector3d a = scene.R * rays.first.direction, &d = rays.second.direction;
    const Eigen::Vector3d b = scene.R * scene.centers[rays.camera1] + scene.t - scene.centers[rays.camera2];
    // depth2 d = depth1 a + b, so depth2 (a × d) = a × b.
    const double depth = a.cross(b).dot(a.cross(d)) / a.cross(d).squaredNorm();
    EXPECT_NEAR(residuals.nearness[i], unit / depth, 1e-6 * unit / depth);
    const double leverage = a.cross(d).squaredNorm() * unit * unit / b.squaredNorm();
    EXPECT_NEAR(residuals.leverages[i], leverage, 1e-12 + 1e-9 * leverage);
  }
}

TEST(CorrespondenceSet, WithoutBaselineTheRotationIsScored) {
  const CorrespondenceScene scene =
      makeCorrespondenceScene(monoShape(), Eigen::Vector3d(0.0, 0.0, 0.05), Eigen::Vector3d::Zero(), 30, 0.5, 0.0, 6);
  const CorrespondenceSet set = scene.set();
  // The camera turns about itself.
  const Eigen::Vector3d t = scene.centers[0] - scene.R * scene.centers[0];
  const CorrespondenceScene turned =
      makeCorrespondenceScene(monoShape(), Eigen::Vector3d(0.0, 0.0, 0.05), t, 30, 0.5, 0.0, 6);
  const CorrespondenceSet turned_set = turned.set();
  for (double error : errorsOf(turned_set, turned.R, turned.t)) EXPECT_LT(error, 3.0);
  int far = 0;
  const Eigen::Vector3d still = scene.centers[0] - scene.centers[0];
  for (double error : errorsOf(turned_set, Eigen::Matrix3d::Identity(), still)) far += error > 5.0;
  EXPECT_EQ(far, turned_set.size());
  for (double error : errorsOf(set, scene.R, scene.t)) EXPECT_TRUE(std::isfinite(error));

  const CorrespondenceSet empty({}, scene.centers, scene.centers);
  EXPECT_EQ(empty.size(), 0);
  EXPECT_EQ(empty.sumOfLosses(scene.R, scene.t, {}, CorrespondenceSet::Part::kAll), 0.0);
}

TEST(RobustLoss, IsTheMeanOverTheThresholds) {
  const RobustLoss loss{0.5, 2.0};
  for (double error : {0.0, 0.2, 0.5, 0.9, 1.5, 1.99, 2.5}) {
    double mean = 0.0;
    const int steps = 20000;
    for (int i = 0; i < steps; ++i) {
      const double threshold = loss.core + (loss.limit - loss.core) * (i + 0.5) / steps;
      mean += std::min(error * error / (threshold * threshold), 1.0) / steps;
    }
    EXPECT_NEAR(loss.value(error), mean, 1e-6) << error;
    if (error > 0.0) {
      const double slope = (loss.value(error + 1e-6) - loss.value(error - 1e-6)) / 2e-6;
      EXPECT_NEAR(loss.weight(error) * 2.0 * error / (loss.core * loss.limit), slope, 1e-5) << error;
    }
  }
  EXPECT_DOUBLE_EQ((RobustLoss{2.0, 2.0}).value(1.0), 0.25);
  EXPECT_EQ((RobustLoss{2.0, 2.0}).weight(1.9), 1.0);
  EXPECT_EQ((RobustLoss{2.0, 2.0}).weight(2.1), 0.0);
}

}  // namespace
}  // namespace multicam_egomotion
