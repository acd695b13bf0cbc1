// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>
#include <vector>

#include "multicam_egomotion/estimation/minimal_solvers.h"
#include "multicam_egomotion/estimation/pixel_correspondences.h"
#include "multicam_egomotion/estimation/robust_estimator.h"
#include "multicam_egomotion/geometry/so3.h"

namespace multicam_egomotion {
namespace {

// A pinhole with distortion and a fisheye, 0.6 m apart, both looking along body x, one of them rolled.
CameraRig makeRig() {
  Eigen::Isometry3d left = Eigen::Isometry3d::Identity();
  left.linear() << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  left.translation() << 0.1, 0.3, 0.2;
  Eigen::Isometry3d right = left;
  right.translation().y() = -0.3;
  right.rotate(Eigen::AngleAxisd(0.2, Eigen::Vector3d::UnitZ()));
  return CameraRig(
      {{"left", "left", CameraModel(752, 480, 458, 457, 367, 248, Distortion::kRadtan, {-0.28, 0.07}), left},
       {"right", "right", CameraModel(640, 480, 240, 241, 320, 240, Distortion::kEquidistant, {0.01}), right}});
}

class PixelCorrespondences : public ::testing::Test {
 protected:
  PixelCorrespondences() {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> share(-1.0, 1.0);
    while (pixels_.size() < 120) {
      const Eigen::Vector3d point(10.0 + 6.0 * share(random), 6.0 * share(random), 4.0 * share(random));
      PixelCorrespondence seen;
      seen.camera1 = static_cast<int>(pixels_.size() % 2);
      seen.camera2 = static_cast<int>(pixels_.size() / 2 % 2);
      if (project(seen.camera1, point, &seen.pixel1) && project(seen.camera2, R_ * point + t_, &seen.pixel2)) {
        pixels_.push_back(seen);
        points_.push_back(point);
      }
    }
  }

  bool project(int camera, const Eigen::Vector3d& point, Eigen::Vector2d* pixel) const {
    const RigCamera& one = rig_.camera(camera);
    return one.model.project(one.T_body_cam.inverse() * point, pixel) && one.model.contains(*pixel);
  }

  const CameraRig rig_ = makeRig();
  const Eigen::Matrix3d R_ = expSO3({0.02, -0.03, 0.1});
  const Eigen::Vector3d t_{-0.8, 0.3, 0.05};
  const VerticalPrior vertical_ = verticalPriorFromUp(Eigen::Vector3d::UnitZ(), R_.col(2));
  std::vector<PixelCorrespondence> pixels_;
  std::vector<Eigen::Vector3d> points_;  // in the body at t1
};

TEST_F(PixelCorrespondences, RaysPassThroughThePoints) {
  for (std::size_t i = 0; i < pixels_.size(); ++i) {
    CorrespondenceSet::Entry entry;
    ASSERT_TRUE(entryFromPixels(rig_, pixels_[i], &entry));
    EXPECT_EQ(entry.rays.camera1, pixels_[i].camera1);
    EXPECT_EQ(entry.rays.camera2, pixels_[i].camera2);
    const Eigen::Vector3d &first = points_[i], second = R_ * points_[i] + t_;
    EXPECT_LT((first.cross(entry.rays.first.direction) - entry.rays.first.moment).norm(), 1e-9);
    EXPECT_LT((second.cross(entry.rays.second.direction) - entry.rays.second.moment).norm(), 1e-9);
    EXPECT_GT(entry.rays.first.direction.dot(first), 0.0);
    EXPECT_GT(entry.rays.second.direction.dot(second), 0.0);
  }
}

// Turning the ray by a small angle moves the pixel by the scale, on the average over the directions.
TEST_F(PixelCorrespondences, ScalesArePixelsPerRadian) {
  for (const PixelCorrespondence& pixels : pixels_) {
    CorrespondenceSet::Entry entry;
    ASSERT_TRUE(entryFromPixels(rig_, pixels, &entry));
    const RigCamera& camera = rig_.camera(pixels.camera1);
    const Eigen::Vector3d bearing = camera.T_body_cam.linear().transpose() * entry.rays.first.direction;
    const Eigen::Vector3d u = bearing.unitOrthogonal(), v = bearing.cross(u);
    double squares = 0.0;
    for (const Eigen::Vector3d& side : {u, v}) {
      Eigen::Vector2d moved;
      ASSERT_TRUE(camera.model.project(bearing + 1e-6 * side, &moved));
      squares += ((moved - pixels.pixel1) / 1e-6).squaredNorm() / 2.0;
    }
    EXPECT_NEAR(entry.pixels_per_radian1, std::sqrt(squares), 0.01);
  }
}

TEST_F(PixelCorrespondences, SolverAndEstimatorFindTheMotion) {
  const PixelCorrespondenceSet all = correspondencesFromPixels(rig_, pixels_);
  ASSERT_EQ(all.indices.size(), pixels_.size());
  const auto poses =
      solveFourPointVertical({all.set.rays(0), all.set.rays(1), all.set.rays(2), all.set.rays(3)}, vertical_);
  EXPECT_TRUE(std::any_of(poses.begin(), poses.end(), [&](const RelativePose& pose) {
    return (pose.R - R_).norm() < 1e-8 && (pose.t - t_).norm() < 1e-6;
  }));
  const RobustEstimate found = estimate<FourPointVertical>(all.set, vertical_, {}, {}, 1);
  ASSERT_TRUE(found.success);
  EXPECT_LT((found.R - R_).norm(), 1e-6);
  EXPECT_LT((found.t - t_).norm(), 1e-5);
}

TEST_F(PixelCorrespondences, PixelsWithoutARayAreLeftOut) {
  pixels_[3].pixel1.x() = std::numeric_limits<double>::quiet_NaN();
  pixels_[7].camera2 = 1;
  pixels_[7].pixel2 << 1e5, 1e5;  // behind the fisheye
  const PixelCorrespondenceSet all = correspondencesFromPixels(rig_, pixels_);
  ASSERT_EQ(all.set.size(), static_cast<int>(pixels_.size()) - 2);
  EXPECT_EQ(all.indices[2], 2);
  EXPECT_EQ(all.indices[3], 4);
  EXPECT_EQ(all.indices[6], 8);
}

TEST_F(PixelCorrespondences, AnUnknownCameraIsRefused) {
  pixels_[5].camera2 = 2;
  try {
    correspondencesFromPixels(rig_, pixels_);
    FAIL() << "accepted";
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(), "pixel correspondence: camera2 is 2, expected 0 to 1");
  }
}

}  // namespace
}  // namespace multicam_egomotion
