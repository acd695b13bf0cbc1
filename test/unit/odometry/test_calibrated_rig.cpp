// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>

#include "multicam_egomotion/geometry/so3.h"
#include "multicam_egomotion/odometry/calibrated_rig.h"

namespace multicam_egomotion {
namespace {

CameraRig threeCameras() {
  std::vector<RigCamera> cameras;
  for (int i = 0; i < 3; ++i) {
    Eigen::Isometry3d T_body_cam = Eigen::Isometry3d::Identity();
    T_body_cam.linear() = expSO3({-1.5 + 0.1 * i, 0.2, 0.3});
    T_body_cam.translation() << 0.1, 0.2 * i, 0.3;
    cameras.push_back({"cam" + std::to_string(i), "frame" + std::to_string(i),
                       CameraModel(640, 480, 400, 400, 320, 240, Distortion::kNone, {}), T_body_cam});
  }
  return CameraRig(cameras);
}

TEST(CalibratedRig, TurnsTheCameraAboutItsOwnAxes) {
  const CameraRig rig = threeCameras();
  CameraCalibration one;
  one.camera = 1;
  one.rotation << 0.01, -0.02, 0.03;
  one.covariance = Eigen::Vector3d(1e-6, 4e-6, 1e-8).asDiagonal();
  one.focal_length = 0.01;
  const CameraRig turned = calibratedRig(rig, {one});
  const RigCamera &before = rig.camera(1), &after = turned.camera(1);
  EXPECT_TRUE(after.T_body_cam.linear().isApprox(before.T_body_cam.linear() * expSO3(one.rotation), 1e-12));
  EXPECT_EQ(after.T_body_cam.translation(), before.T_body_cam.translation());
  EXPECT_EQ(after.model.fx(), before.model.fx());
  EXPECT_NEAR(after.sigmas.rotation, 2e-3, 1e-12);
  EXPECT_EQ(after.sigmas.position, before.sigmas.position);
  for (int i : {0, 2}) {
    EXPECT_TRUE(turned.camera(i).T_body_cam.isApprox(rig.camera(i).T_body_cam, 1e-14));
    EXPECT_EQ(turned.camera(i).sigmas.rotation, rig.camera(i).sigmas.rotation);
  }
}

TEST(CalibratedRig, TheSigmaIsTheLargestInAnyDirectionButNotBelowWhatCanBeProven) {
  CameraCalibration one;
  one.camera = 2;
  const double sigma = 0.05 * M_PI / 180.0;
  const Eigen::Vector3d axis = Eigen::Vector3d(1, 2, -2) / 3.0;
  one.covariance = sigma * sigma * axis * axis.transpose();
  EXPECT_NEAR(calibratedRig(threeCameras(), {one}).camera(2).sigmas.rotation, sigma, 1e-9);
  one.covariance *= 1e-4;
  EXPECT_NEAR(calibratedRig(threeCameras(), {one}).camera(2).sigmas.rotation, 0.005 * M_PI / 180.0, 1e-12);
}

TEST(CalibratedRig, IsTheSameWithoutCalibration) {
  const CameraRig rig = threeCameras(), same = calibratedRig(rig, {});
  for (int i = 0; i < 3; ++i) {
    EXPECT_TRUE(same.camera(i).T_body_cam.isApprox(rig.camera(i).T_body_cam, 1e-14));
    EXPECT_EQ(same.camera(i).sigmas.rotation, rig.camera(i).sigmas.rotation);
  }
}

}  // namespace
}  // namespace multicam_egomotion
