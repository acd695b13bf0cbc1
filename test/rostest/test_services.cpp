// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
// The services of a running odometry, and that it runs: a jump of odom only where one was asked for.
#include <gtest/gtest.h>
#include <multicam_egomotion/Calibration.h>
#include <multicam_egomotion/EgoMotion.h>
#include <multicam_egomotion/SetPose.h>
#include <nav_msgs/Odometry.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <std_srvs/Trigger.h>

#include <functional>

namespace {

class Services : public ::testing::Test {
 protected:
  Services()
      : odometry_subscriber_(node_.subscribe("odometry", 100, &Services::receiveOdometry, this)),
        motion_subscriber_(node_.subscribe("ego_motion", 100, &Services::receiveMotion, this)) {}

  void receiveOdometry(const nav_msgs::Odometry::ConstPtr& message) { odometry_ = message; }
  void receiveMotion(const multicam_egomotion::EgoMotion::ConstPtr& message) { motion_ = message; }

  /// Spins until the condition holds, at most so long by the wall clock.
  bool waitFor(const std::function<bool()>& condition, double seconds = 40.0) {
    const ros::WallTime end = ros::WallTime::now() + ros::WallDuration(seconds);
    while (ros::ok() && ros::WallTime::now() < end) {
      ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(0.02));
      if (condition()) return true;
    }
    return false;
  }

  ros::NodeHandle node_;
  nav_msgs::Odometry::ConstPtr odometry_;
  multicam_egomotion::EgoMotion::ConstPtr motion_;
  ros::Subscriber odometry_subscriber_, motion_subscriber_;
};

TEST_F(Services, SetPoseAndResetStartNewEpochs) {
  ASSERT_TRUE(waitFor([this] { return odometry_ != nullptr && motion_ != nullptr; })) << "no odometry";
  EXPECT_EQ(odometry_->header.frame_id, "odom");
  EXPECT_EQ(odometry_->child_frame_id, "base_link");
  const std::uint32_t epoch = motion_->odom_epoch;

  multicam_egomotion::SetPose pose;
  pose.request.pose.position.x = 100.0;
  pose.request.pose.orientation.w = 1.0;
  ASSERT_TRUE(ros::service::call("egomotion/set_pose", pose));
  EXPECT_TRUE(pose.response.success) << pose.response.message;
  EXPECT_TRUE(waitFor([&] { return motion_->odom_epoch == epoch + 1; }));
  EXPECT_TRUE(waitFor([&] { return std::abs(odometry_->pose.pose.position.x - 100.0) < 2.0; }));

  std_srvs::Trigger pause, resume;
  ASSERT_TRUE(ros::service::call("egomotion/pause", pause));
  EXPECT_TRUE(pause.response.success);
  waitFor([] { return false; }, 0.3);  // what was under way
  odometry_ = nullptr;
  EXPECT_FALSE(waitFor([this] { return odometry_ != nullptr; }, 1.0));
  // The last calibration is kept for who comes later.
  multicam_egomotion::Calibration::ConstPtr calibration;
  const boost::function<void(const multicam_egomotion::Calibration::ConstPtr&)> keep =
      [&calibration](const multicam_egomotion::Calibration::ConstPtr& message) { calibration = message; };
  const ros::Subscriber late = node_.subscribe<multicam_egomotion::Calibration>("calibration", 1, keep);
  ASSERT_TRUE(waitFor([&calibration] { return calibration != nullptr; }, 10.0)) << "no calibration";
  EXPECT_EQ(calibration->header.frame_id, "base_link");
  ASSERT_EQ(calibration->cameras.size(), 1u);
  EXPECT_EQ(calibration->cameras[0].name, "cam1");
  EXPECT_TRUE(calibration->cameras[0].overlaps);
  EXPECT_GT(calibration->cameras[0].rotation_covariance[0], 0.0);
  ASSERT_TRUE(ros::service::call("egomotion/resume", resume));
  EXPECT_TRUE(resume.response.success);
  EXPECT_TRUE(waitFor([this] { return odometry_ != nullptr; }));

  std_srvs::Trigger reset;
  ASSERT_TRUE(ros::service::call("egomotion/reset", reset));
  EXPECT_TRUE(reset.response.success) << reset.response.message;
  EXPECT_TRUE(waitFor([&] { return motion_->odom_epoch == epoch + 2; }));
  EXPECT_TRUE(waitFor([&] { return std::abs(odometry_->pose.pose.position.x) < 2.0; }));

  pose.request.pose.orientation.w = 0.0;
  ASSERT_TRUE(ros::service::call("egomotion/set_pose", pose));
  EXPECT_FALSE(pose.response.success);
  EXPECT_FALSE(pose.response.message.empty());
}

}  // namespace

int main(int argc, char** argv) {
  ros::init(argc, argv, "test_services");
  ::testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
