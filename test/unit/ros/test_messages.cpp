// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <limits>
#include <map>
#include <string>

#include "multicam_egomotion/ros/calibration_message.h"
#include "multicam_egomotion/ros/diagnostics.h"
#include "multicam_egomotion/ros/messages.h"

namespace multicam_egomotion {
namespace {

Matrix6d published(const Matrix6d& covariance) {
  return Eigen::Map<const Matrix6d>(toRosCovariance(covariance).data());
}

void expectPublishable(const Matrix6d& covariance) {
  EXPECT_TRUE(covariance.isApprox(covariance.transpose(), 0.0));
  EXPECT_EQ(covariance.llt().info(), Eigen::Success) << covariance;
  EXPECT_GE(covariance.diagonal().minCoeff(), 1e-10);
  EXPECT_LE(covariance.diagonal().maxCoeff(), 1e6);
}

TEST(Covariance, GoodOnesAreUnchanged) {
  std::srand(1);
  const Matrix6d A = Matrix6d::Random();
  const Matrix6d covariance = A * A.transpose() + 0.01 * Matrix6d::Identity();
  EXPECT_TRUE(published(covariance).isApprox(covariance, 1e-12));
}

TEST(Covariance, ALimitOfOneAxisLeavesWhatTheOthersSay) {
  // A rotation known to 1.5e-5 rad that goes with the translation: less is known of either than of both.
  Matrix6d covariance = Matrix6d::Identity() * 1e-8;
  covariance.bottomRightCorner<3, 3>() *= 0.0225;
  for (int i : {0, 1, 2}) covariance(i, i + 3) = covariance(i + 3, i) = 0.95 * 1e-4 * 1.5e-5;
  EXPECT_TRUE(published(covariance).isApprox(covariance, 1e-9));
  covariance.row(4) *= 0.1;
  covariance.col(4) *= 0.1;
  const Matrix6d raised = published(covariance);
  EXPECT_NEAR(raised(4, 4), 1e-10, 1e-16);
  EXPECT_NEAR(raised(1, 4) / std::sqrt(raised(1, 1) * raised(4, 4)), 0.95, 0.2);
  EXPECT_NEAR(raised(3, 3), covariance(3, 3), 1e-16);
}

TEST(Covariance, ZeroHugeSingularAndInvalidOnesBecomePositiveDefinite) {
  expectPublishable(published(Matrix6d::Zero()));
  expectPublishable(published(1e12 * Matrix6d::Identity()));
  expectPublishable(published(Matrix6d::Ones()));
  expectPublishable(published(1e9 * Matrix6d::Ones()));
  Matrix6d invalid = Matrix6d::Identity();
  invalid(1, 4) = std::numeric_limits<double>::quiet_NaN();
  expectPublishable(published(invalid));
  EXPECT_EQ(published(invalid)(0, 0), 1e6);
}

EgoMotionResult movedResult() {
  EgoMotionResult result;
  result.stamp_ns = 1400000000123456789;
  result.previous_stamp_ns = 1400000000073456789;
  result.T_odom_body.pose.translation() << 1, 2, 3;
  result.T_previous_body.pose.linear() = Eigen::AngleAxisd(0.1, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  result.T_previous_body.pose.translation() << 0.1, 0, 0;
  result.twist.linear << 2, 0, 0;
  result.points = {{1, 2, 3}, {4, 5, 6}};
  return result;
}

TEST(Messages, FramesAndStamps) {
  const EgoMotionResult result = movedResult();
  const FrameNames frames{"odom", "base"};
  const nav_msgs::Odometry odometry = toOdometry(result, frames);
  EXPECT_EQ(toNanoseconds(odometry.header.stamp), result.stamp_ns);
  EXPECT_EQ(odometry.header.frame_id, "odom");
  EXPECT_EQ(odometry.child_frame_id, "base");
  EXPECT_EQ(odometry.pose.pose.position.z, 3.0);
  EXPECT_EQ(odometry.twist.twist.linear.x, 2.0);
  const nav_msgs::Odometry relative = toRelativePose(result, frames);
  EXPECT_EQ(relative.header.frame_id, "base_previous");
  EXPECT_EQ(relative.child_frame_id, "base");
  EXPECT_EQ(relative.pose.pose.position.x, 0.1);
  EXPECT_EQ(toRosTime(-5), ros::Time(0));
}

TEST(Messages, PreviousTransformIsTheInverse) {
  const EgoMotionResult result = movedResult();
  const geometry_msgs::TransformStamped transform = toPreviousTransform(result, {"odom", "base"});
  EXPECT_EQ(transform.header.frame_id, "base");
  EXPECT_EQ(transform.child_frame_id, "base_previous");
  const Eigen::Vector3d t = result.T_previous_body.pose.inverse().translation();
  EXPECT_NEAR(transform.transform.translation.x, t.x(), 1e-15);
  EXPECT_NEAR(transform.transform.translation.y, t.y(), 1e-15);
}

TEST(Messages, PointCloud) {
  const sensor_msgs::PointCloud2 cloud = toPointCloud(movedResult(), {"odom", "base"});
  EXPECT_EQ(cloud.width * cloud.height, 2u);
  EXPECT_EQ(cloud.header.frame_id, "odom");
  EXPECT_EQ(*reinterpret_cast<const float*>(&cloud.data[cloud.point_step + 8]), 6.0f);
}

TEST(Messages, PointCloudOfNoPoints) {
  EgoMotionResult result = movedResult();
  result.points.clear();
  const sensor_msgs::PointCloud2 cloud = toPointCloud(result, {"odom", "base"});
  EXPECT_EQ(cloud.width * cloud.height, 0u);
  EXPECT_EQ(cloud.fields.size(), 3u);
}

/// Two cameras beside each other, and what is known of the second.
CameraRig stereoRig() {
  const CameraModel model(640, 480, 400, 400, 320, 240, Distortion::kNone, {});
  const Eigen::Isometry3d left = Eigen::Isometry3d::Identity(), right(Eigen::Translation3d(0.1, 0, 0));
  return CameraRig({{"left", "left_optical", model, left}, {"right", "right_optical", model, right}});
}

CameraCalibration calibrationOfTheSecond() {
  CameraCalibration one;
  one.camera = 1;
  one.rotation << 0.001, -0.002, 0.003;
  one.covariance << 4e-8, 1e-9, 2e-9, 1e-9, 9e-8, 3e-9, 2e-9, 3e-9, 1e-8;
  one.overlaps = true;
  one.focal_length = 0.0015;
  one.static_error_px = 0.25;
  return one;
}

TEST(Messages, CalibrationNamesTheCamera) {
  const CameraCalibration one = calibrationOfTheSecond();
  const Calibration message = toCalibrationMessage({one}, stereoRig(), 1400000000123456789, {"odom", "base"});
  EXPECT_EQ(toNanoseconds(message.header.stamp), 1400000000123456789);
  EXPECT_EQ(message.header.frame_id, "base");
  ASSERT_EQ(message.cameras.size(), 1u);
  const CalibratedCamera& camera = message.cameras[0];
  EXPECT_EQ(camera.name, "right");
  EXPECT_EQ(camera.rotation.x, 0.001);
  EXPECT_EQ(camera.rotation.y, -0.002);
  EXPECT_EQ(camera.rotation.z, 0.003);
  for (int row = 0; row < 3; ++row) {
    for (int col = 0; col < 3; ++col) EXPECT_EQ(camera.rotation_covariance[3 * row + col], one.covariance(row, col));
  }
  EXPECT_TRUE(camera.overlaps);
  EXPECT_EQ(camera.focal_length, 0.0015);
  EXPECT_EQ(camera.static_error_px, 0.25);
}

TEST(Messages, CalibrationComesOnceASecond) {
  const EgoMotion odometry(stereoRig(), ImuCalibration(), EgoMotionOptions());
  CalibrationMessages messages;
  const auto comes = [&](std::int64_t stamp_ns) { return messages.next(odometry, stamp_ns, {}).has_value(); };
  const std::int64_t begin = 1400000000000000000;
  EXPECT_TRUE(comes(begin));
  EXPECT_FALSE(comes(begin));
  EXPECT_FALSE(comes(begin + 999999999));
  EXPECT_TRUE(comes(begin + 1000000000));
  EXPECT_FALSE(comes(begin + 1500000000));
  EXPECT_TRUE(comes(begin)) << "stamps jumped back";
  EXPECT_TRUE(comes(begin + 60000000000));
}

TEST(Messages, NoCalibrationOfOneCameraOrWhenItIsSwitchedOff) {
  CalibrationMessages messages;
  EgoMotionOptions options;
  const EgoMotion one_camera(CameraRig({stereoRig().camera(0)}), ImuCalibration(), options);
  EXPECT_FALSE(messages.next(one_camera, 1, {}));
  options.calibrate_online = false;
  const EgoMotion switched_off(stereoRig(), ImuCalibration(), options);
  EXPECT_FALSE(CalibrationMessages().next(switched_off, 1, {}));
}

TEST(Diagnostics, TellTheCalibration) {
  Health health;
  health.result.emplace();
  health.cameras = {"left", "right"};
  health.calibration = {calibrationOfTheSecond()};
  const auto values = [&health] {
    diagnostic_updater::DiagnosticStatusWrapper status;
    describe(health, status);
    std::map<std::string, std::string> all;
    for (const auto& value : status.values) all[value.key] = value.value;
    return all;
  };
  EXPECT_EQ(values()["right rotation"], "0.057 -0.115 0.172 deg (sigma 0.011 0.017 0.006)");
  EXPECT_EQ(values()["right focal length [%]"], "0.150");
  EXPECT_EQ(values()["right static error [px]"], "0.25");
  health.calibration[0].overlaps = false;
  EXPECT_EQ(values().count("right rotation"), 1u);
  EXPECT_EQ(values().count("right static error [px]"), 0u);
}

TEST(Messages, ImuOrientationNeedsACovariance) {
  sensor_msgs::Imu imu;
  imu.orientation.w = 1.0;
  EXPECT_LT(toImuSample(imu).orientation_sigma, 0.0);  // covariance of zeros: unknown
  imu.orientation_covariance = {0.04, 0, 0, 0, 0.01, 0, 0, 0, 1};
  EXPECT_DOUBLE_EQ(toImuSample(imu).orientation_sigma, 0.2);
  imu.orientation.w = 0.0;
  EXPECT_LT(toImuSample(imu).orientation_sigma, 0.0);
  imu.orientation.w = 1.0;
  imu.orientation_covariance[0] = -1.0;
  EXPECT_LT(toImuSample(imu).orientation_sigma, 0.0);
}

}  // namespace
}  // namespace multicam_egomotion
