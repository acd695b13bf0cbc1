// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "multicam_egomotion/geometry/camera_rig.h"

namespace multicam_egomotion {
namespace {

const CameraModel kEuroc(752, 480, 458.654, 457.296, 367.215, 248.375, Distortion::kRadtan,
                         {-0.28340811, 0.07395907, 0.00019359, 1.76187114e-05});
const CameraModel kFisheye190(800, 800, 240, 240, 399.5, 399.5, Distortion::kEquidistant, {});

// Optical frame that looks along body yaw `yaw_deg` (0 = body x), mounted at `position`.
RigCamera makeCamera(const std::string& name, const CameraModel& model, double yaw_deg,
                     const Eigen::Vector3d& position) {
  Eigen::Matrix3d R_body_optical;
  R_body_optical << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = Eigen::AngleAxisd(yaw_deg * M_PI / 180, Eigen::Vector3d::UnitZ()).toRotationMatrix() * R_body_optical;
  T.translation() = position;
  return {name, name + "_optical", model, T, 0.0};
}

TEST(CameraRig, StereoPairOverlapsAlmostFully) {
  const CameraRig rig({makeCamera("left", kEuroc, 0, {0, 0.055, 0}), makeCamera("right", kEuroc, 0, {0, -0.055, 0})});
  EXPECT_GT(rig.overlap(0, 1), 0.95);
  EXPECT_LT(rig.overlap(0, 1), 1.0);
  EXPECT_NEAR(rig.overlap(0, 1), rig.overlap(1, 0), 0.02);
  EXPECT_EQ(rig.overlappingCameras(0), std::vector<int>{1});
  EXPECT_EQ(rig.overlappingCameras(1), std::vector<int>{0});
  EXPECT_NEAR(rig.baseline(), 0.11, 1e-12);
}

TEST(CameraRig, FourOutwardCamerasDoNotOverlap) {
  std::vector<RigCamera> cameras;
  for (int i = 0; i < 4; ++i) {
    const double yaw = 90.0 * i;
    cameras.push_back(makeCamera("cam" + std::to_string(i), kEuroc, yaw,
                                 {std::cos(yaw * M_PI / 180), std::sin(yaw * M_PI / 180), 0}));
  }
  const CameraRig rig(cameras);
  for (int from = 0; from < 4; ++from) {
    EXPECT_TRUE(rig.overlappingCameras(from).empty()) << from;
    EXPECT_EQ(rig.overlap(from, (from + 2) % 4), 0.0);
  }
  EXPECT_NEAR(rig.baseline(), 2.0, 1e-12);
}

// 190 degrees across the sides, more towards the corners: a ring round the seam is seen by both, the centres are not.
TEST(CameraRig, OppositeFisheyesShareARing) {
  const double focal = 399.5 / (95 * M_PI / 180);
  const CameraModel circle(800, 800, focal, focal, 399.5, 399.5, Distortion::kEquidistant, {});
  const CameraRig rig({makeCamera("front", circle, 0, {0.05, 0, 0}), makeCamera("back", circle, 180, {-0.05, 0, 0})});
  // What is less than 45 deg from the other camera's axis backwards lies outside its picture.
  const double centre = M_PI / 4 * std::pow(45.0 / 95.0, 2), inside_85 = M_PI / 4 * std::pow(85.0 / 95.0, 2);
  EXPECT_GT(rig.overlap(0, 1), 1 - inside_85);
  EXPECT_LT(rig.overlap(0, 1), 1 - centre);
  EXPECT_EQ(rig.overlappingCameras(0), std::vector<int>{1});
}

TEST(CameraRig, OverlapDependsOnTheDirectionOfTheQuestion) {
  // All of the narrow view is seen by the wide camera beside it, not the other way round.
  const CameraModel narrow(640, 480, 1500, 1500, 319.5, 239.5, Distortion::kNone, {});
  const CameraRig rig({makeCamera("wide", kFisheye190, 0, {0, 0, 0}), makeCamera("narrow", narrow, 0, {0, 0.1, 0})});
  EXPECT_EQ(rig.overlap(1, 0), 1.0);
  EXPECT_LT(rig.overlap(0, 1), 0.1);
  EXPECT_EQ(rig.overlap(0, 0), 1.0);
}

TEST(CameraRig, NeighboursAreSortedByOverlap) {
  const CameraRig rig({makeCamera("a", kEuroc, 0, {0, 0, 0}), makeCamera("b", kEuroc, 40, {0, 0, 0}),
                       makeCamera("c", kEuroc, 15, {0, 0, 0})});
  EXPECT_EQ(rig.overlappingCameras(0), (std::vector<int>{2, 1}));
}

TEST(CameraRig, RemovesTheRoundingOfAFile) {
  RigCamera camera = makeCamera("cam0", kEuroc, 33, {0, 0, 0});
  for (int i = 0; i < 9; ++i) {
    double& entry = camera.T_body_cam.linear()(i / 3, i % 3);
    entry = std::round(entry * 1e4) / 1e4;
  }
  const CameraRig rig({camera});
  const Eigen::Matrix3d R = rig.camera(0).T_body_cam.linear();
  EXPECT_LT((R.transpose() * R - Eigen::Matrix3d::Identity()).norm(), 1e-14);
  EXPECT_LT((R - camera.T_body_cam.linear()).norm(), 2e-4);
}

void expectRefusal(std::vector<RigCamera> cameras, const std::string& part) {
  try {
    const CameraRig rig(std::move(cameras));
    ADD_FAILURE() << "accepted: " << part;
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find("expected"), std::string::npos) << error.what();
  }
}

TEST(CameraRig, InvalidRigsThrowWithAMessage) {
  expectRefusal({}, "number of cameras is 0");
  expectRefusal(std::vector<RigCamera>(9, makeCamera("c", kEuroc, 0, {0, 0, 0})), "number of cameras is 9");

  RigCamera scaled = makeCamera("scaled", kEuroc, 0, {0, 0, 0});
  scaled.T_body_cam.linear() *= 1.1;
  expectRefusal({scaled}, "'scaled' is not a rigid motion");

  RigCamera mirrored = makeCamera("mirrored", kEuroc, 0, {0, 0, 0});
  mirrored.T_body_cam.linear().col(0) *= -1;
  expectRefusal({mirrored}, "'mirrored' is not a rigid motion");

  RigCamera undefined = makeCamera("undefined", kEuroc, 0, {0, 0, 0});
  undefined.T_body_cam.translation().x() = std::numeric_limits<double>::quiet_NaN();
  expectRefusal({undefined}, "'undefined' is not a rigid motion");

  expectRefusal({makeCamera("millimetres", kEuroc, 0, {0, 110, 0})}, "'millimetres' puts it 110");

  RigCamera nanoseconds = makeCamera("nanoseconds", kEuroc, 0, {0, 0, 0});
  nanoseconds.time_offset_s = 3e6;
  expectRefusal({nanoseconds}, "time_offset_s of camera 'nanoseconds' is 3000000");
}

}  // namespace
}  // namespace multicam_egomotion
