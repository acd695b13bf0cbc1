// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "multicam_egomotion/tracking/calibration_check.h"

namespace multicam_egomotion {
namespace {

constexpr double kDegree = M_PI / 180.0;
constexpr double kFocalLength = 400.0;

CameraRig pinholePair() {
  std::vector<RigCamera> cameras;
  for (int i : {0, 1}) {
    Eigen::Isometry3d T_body_cam = Eigen::Isometry3d::Identity();
    T_body_cam.translation().x() = 0.2 * i;
    const std::string name = "cam" + std::to_string(i);
    cameras.push_back({name, name, CameraModel(640, 480, kFocalLength, kFocalLength, 320, 240, Distortion::kNone, {}),
                       T_body_cam, 0.0});
  }
  return CameraRig(cameras);
}

struct SeenPairs {
  double pixel_sigma = 0.3;
  double outliers = 0.2;  ///< share of pairs that have nothing to do with each other
  int frames = 20;
  int a_frame = 60;  ///< pairs
};

// What a rig of which cam1 is turned by `turn` against its calibration sees of points 1 to 20 m away.
CalibrationCheck see(const CameraRig& rig, const Eigen::Vector3d& turn, const SeenPairs& pairs = {}) {
  CalibrationCheck check(rig);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  std::normal_distribution<double> noise(0.0, pairs.pixel_sigma);
  const CameraModel& model = rig.camera(0).model;
  const Eigen::Isometry3d T_1_0 = rig.camera(1).T_body_cam.inverse() * rig.camera(0).T_body_cam;
  const Eigen::Isometry3d T_turned_0 = Eigen::AngleAxisd(turn.norm(), turn.normalized()) * T_1_0;
  for (int frame = 0; frame < pairs.frames; ++frame) {
    for (int pair = 0; pair < pairs.a_frame; ++pair) {
      ImagePoint in_0, in_1;
      EXPECT_TRUE(makeImagePoint(model, {640 * uniform(random), 480 * uniform(random)}, &in_0));
      Eigen::Vector2d pixel(640 * uniform(random), 480 * uniform(random));
      const double distance = 1.0 / (0.05 + 0.95 * uniform(random));
      if (uniform(random) > pairs.outliers) model.project(T_turned_0 * (distance * in_0.bearing), &pixel);
      if (!makeImagePoint(model, pixel + Eigen::Vector2d(noise(random), noise(random)), &in_1)) continue;
      if (pair % 2) {
        check.add(0, in_0, 1, in_1, T_1_0);
      } else {
        check.add(1, in_1, 0, in_0, T_1_0.inverse());
      }
    }
    check.endFrame();
  }
  return check;
}

TEST(CalibrationCheck, IsSilentAboutARightCalibration) {
  const CameraRig rig = pinholePair();
  for (const double sigma : {0.1, 0.5, 1.0}) {
    SeenPairs pairs;
    pairs.pixel_sigma = sigma;
    EXPECT_TRUE(see(rig, Eigen::Vector3d::Zero(), pairs).faults().empty()) << sigma;
  }
}

TEST(CalibrationCheck, FindsTheTurnOfACamera) {
  const CameraRig rig = pinholePair();
  for (const double angle : {0.3, 1.0}) {
    for (const Eigen::Vector3d& axis :
         {Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(-1, 0, 0), Eigen::Vector3d(0.6, 0, 0.8)}) {
      const CalibrationCheck check = see(rig, angle * kDegree * axis);
      SCOPED_TRACE(angle);
      const auto turn = check.turn(0, 1);
      ASSERT_TRUE(turn);
      EXPECT_NEAR(turn->angle / kDegree, angle, 0.1 * angle);
      EXPECT_GT(turn->explained_px, turn->left_px);
      ASSERT_EQ(check.faults().size(), 1u);
      EXPECT_NE(check.faults()[0].find("cam1 disagrees with cam0: turned by "), std::string::npos) << check.faults()[0];
    }
  }
}

TEST(CalibrationCheck, SmallTurnsAreMeasuredButNotNamed) {
  const CameraRig rig = pinholePair();
  const CalibrationCheck check = see(rig, {0.05 * kDegree, 0, 0});
  const auto turn = check.turn(0, 1);
  ASSERT_TRUE(turn);
  EXPECT_NEAR(turn->angle / kDegree, 0.05, 0.01);
  EXPECT_TRUE(check.faults().empty());
}

TEST(CalibrationCheck, SaysNothingOfFewPairs) {
  const CameraRig rig = pinholePair();
  SeenPairs pairs;
  pairs.frames = 1;
  const CalibrationCheck check = see(rig, {1.0 * kDegree, 0, 0}, pairs);
  EXPECT_FALSE(check.turn(0, 1));
  EXPECT_TRUE(check.faults().empty());
}

TEST(CalibrationCheck, ForgetsWhatItHasNotSeenForLong) {
  const CameraRig rig = pinholePair();
  CalibrationCheck check = see(rig, {1.0 * kDegree, 0, 0});
  for (int frame = 0; frame < 200; ++frame) check.endFrame();
  EXPECT_TRUE(check.faults().empty());
}

}  // namespace
}  // namespace multicam_egomotion
