// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "multicam_egomotion/ros/rig_from_topics.h"

namespace multicam_egomotion {
namespace {

sensor_msgs::CameraInfo info(const std::string& frame, double Tx = 0.0) {
  sensor_msgs::CameraInfo message;
  message.header.frame_id = frame;
  message.width = 640;
  message.height = 480;
  message.distortion_model = "plumb_bob";
  message.D = {-0.2, 0.05, 0.001, 0.002, 0.0};
  message.K = {400, 0, 320, 0, 401, 240, 0, 0, 1};
  message.R = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  message.P = {380, 0, 310, Tx, 0, 380, 230, 0, 0, 0, 1, 0};
  return message;
}

void place(const std::string& frame, double y, tf2::BufferCore* tf) {
  geometry_msgs::TransformStamped transform;
  transform.header.frame_id = "base_link";
  transform.child_frame_id = frame;
  transform.transform.translation.y = y;
  transform.transform.rotation.x = transform.transform.rotation.z = -0.5;  // optical axes of a forward camera
  transform.transform.rotation.y = transform.transform.rotation.w = 0.5;
  tf->setTransform(transform, "test", true);
}

TEST(RigFromTopics, OwnFramesComeFromTf) {
  tf2::BufferCore tf;
  std::vector<std::string> warnings;
  const std::vector<sensor_msgs::CameraInfo> infos = {info("left"), info("right", -380 * 0.2)};
  place("left", 0.1, &tf);
  EXPECT_FALSE(rigFromCameraInfo(infos, false, 0.0, tf, "base_link", &warnings));
  place("right", -0.1, &tf);
  const auto rig = rigFromCameraInfo(infos, false, 0.25, tf, "base_link", &warnings);
  ASSERT_TRUE(rig);
  EXPECT_NEAR(rig->baseline(), 0.2, 1e-12);
  EXPECT_NEAR(rig->camera(1).T_body_cam.translation().y(), -0.1, 1e-12);
  EXPECT_EQ(rig->camera(1).time_offset_s, 0.25);
  EXPECT_TRUE(warnings.empty());
}

TEST(RigFromTopics, ProjectionIsCheckedAgainstTf) {
  tf2::BufferCore tf;
  std::vector<std::string> warnings;
  place("left", 0.1, &tf);
  place("right", -0.1, &tf);
  const auto rig = rigFromCameraInfo({info("left"), info("right", -380 * 0.3)}, false, 0, tf, "base_link", &warnings);
  ASSERT_TRUE(rig);
  EXPECT_NEAR(rig->baseline(), 0.2, 1e-12);
  EXPECT_EQ(warnings.size(), 1u);
}

TEST(RigFromTopics, SharedFrameTakesTheBaselineOfP) {
  tf2::BufferCore tf;
  std::vector<std::string> warnings;
  place("stereo", 0.1, &tf);
  const auto rig = rigFromCameraInfo({info("stereo"), info("stereo", -380 * 0.2)}, true, 0, tf, "base_link", &warnings);
  ASSERT_TRUE(rig);
  EXPECT_NEAR(rig->camera(0).T_body_cam.translation().y(), 0.1, 1e-12);
  EXPECT_NEAR(rig->camera(1).T_body_cam.translation().y(), -0.1, 1e-12);  // to the right: -y of the body
  EXPECT_THROW(rigFromCameraInfo({info("stereo"), info("stereo")}, true, 0, tf, "base_link", &warnings),
               std::invalid_argument);
}

TEST(RigFromTopics, SharedFrameOfUnrectifiedCamerasUsesTheRectification) {
  tf2::BufferCore tf;
  std::vector<std::string> warnings;
  place("stereo", 0.0, &tf);
  sensor_msgs::CameraInfo left = info("stereo"), right = info("stereo", -380 * 0.2);
  const Eigen::Matrix3d R = Eigen::AngleAxisd(0.05, Eigen::Vector3d::UnitY()).toRotationMatrix();
  Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(right.R.data()) = R;  // rectified <- right camera
  const auto rig = rigFromCameraInfo({left, right}, false, 0, tf, "base_link", &warnings);
  ASSERT_TRUE(rig);
  const Eigen::Isometry3d T_left_right = rig->camera(0).T_body_cam.inverse() * rig->camera(1).T_body_cam;
  EXPECT_TRUE(T_left_right.linear().isApprox(R, 1e-9));
  EXPECT_TRUE(T_left_right.translation().isApprox(Eigen::Vector3d(0.2, 0, 0), 1e-9));
}

TEST(RigFromTopics, ModelsBinningAndRegion) {
  sensor_msgs::CameraInfo message = info("left");
  EXPECT_EQ(cameraModelFromInfo(message, false).distortion(), Distortion::kRadtan);
  const CameraModel rectified = cameraModelFromInfo(message, true);
  EXPECT_EQ(rectified.distortion(), Distortion::kNone);
  EXPECT_EQ(rectified.fx(), 380.0);
  message.binning_x = message.binning_y = 2;
  message.roi.x_offset = 100;
  message.roi.width = 400;
  message.roi.height = 480;
  const CameraModel binned = cameraModelFromInfo(message, false);
  EXPECT_EQ(binned.width(), 200);
  EXPECT_EQ(binned.height(), 240);
  EXPECT_EQ(binned.fx(), 200.0);
  EXPECT_EQ(binned.cx(), 110.0);
  message = info("left");
  message.distortion_model = "equidistant";
  message.D.resize(4);
  EXPECT_EQ(cameraModelFromInfo(message, false).distortion(), Distortion::kEquidistant);
  message.distortion_model = "magic";
  EXPECT_THROW(cameraModelFromInfo(message, false), std::invalid_argument);
  message.K[0] = 0;
  EXPECT_THROW(cameraModelFromInfo(message, false), std::invalid_argument);
}

TEST(RigFromTopics, ChangesAreSeen) {
  sensor_msgs::CameraInfo a = info("left"), b = a;
  b.header.seq = 9;
  EXPECT_TRUE(sameCalibration(a, b));
  b.K[2] += 1;
  EXPECT_FALSE(sameCalibration(a, b));
}

}  // namespace
}  // namespace multicam_egomotion
