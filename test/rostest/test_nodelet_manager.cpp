// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
// Odometries and a camera in one nodelet manager: no copies of images, neighbours that do not disturb each other,
// unloading, and parameters that change while running.
#include <diagnostic_msgs/DiagnosticArray.h>
#include <dynamic_reconfigure/Reconfigure.h>
#include <gtest/gtest.h>
#include <malloc.h>
#include <multicam_egomotion/EgoMotion.h>
#include <nav_msgs/Odometry.h>
#include <nodelet/loader.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <pluginlib/class_loader.hpp>

#include "camera_nodelet.h"

namespace {

using multicam_egomotion::CameraNodelet;
using multicam_egomotion::EgoMotion;

/// The odometry at /<name>/egomotion with what it publishes.
struct Instance {
  explicit Instance(const std::string& name) : nodelet("/" + name + "/egomotion") {
    const boost::function<void(const EgoMotion::ConstPtr&)> motion = [this](const EgoMotion::ConstPtr& message) {
      last_motion = message;
    };
    const boost::function<void(const nav_msgs::Odometry::ConstPtr&)> odometry =
        [this](const nav_msgs::Odometry::ConstPtr&) { ++poses; };
    ros::NodeHandle node(name);
    subscribers = {node.subscribe<EgoMotion>("ego_motion", 100, motion),
                   node.subscribe<nav_msgs::Odometry>("odometry", 100, odometry)};
  }

  const std::string nodelet;
  int poses = 0;
  EgoMotion::ConstPtr last_motion;
  std::vector<ros::Subscriber> subscribers;
};

/// More processes want to run than there are processor cores.
bool starved() {
  double load = 0.0;
  return getloadavg(&load, 1) == 1 && load > std::thread::hardware_concurrency();
}

/// What this process has allocated and not freed [MB]; not what its heap keeps for later, which depends on the order in
/// which threads allocate. Zero with sanitizers that bring a heap of their own.
double allocatedMegabytes() {
#if __GLIBC_PREREQ(2, 33)
  const struct mallinfo2 heap = ::mallinfo2();
#else
  const struct mallinfo heap = ::mallinfo();
#endif
  return (static_cast<double>(heap.uordblks) + static_cast<double>(heap.hblkhd)) * 1e-6;
}

class NodeletManager : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    std::string bag;
    ASSERT_TRUE(ros::param::get("~bag", bag));
    ASSERT_TRUE(ros::param::get("~rig", rig_));
    double rate = 0.0;
    ASSERT_TRUE(ros::param::get("~rate", rate));
    CameraNodelet::setRecording(bag, 4.0, rate);
  }

  NodeletManager()
      : plugins_("nodelet", "nodelet::Nodelet"),
        manager_([this](const std::string& type) -> boost::shared_ptr<nodelet::Nodelet> {
          if (type == "camera") return boost::make_shared<CameraNodelet>();
          return plugins_.createInstance(type);
        }) {}

  bool load(const std::string& name, bool with_rig = true) {
    if (with_rig) ros::param::set(name + "/rig_file", rig_);
    return manager_.load(name, "multicam_egomotion/EgoMotionNodelet", {}, {});
  }
  bool loadCamera() { return manager_.load("/camera", "camera", {}, {}); }

  /// Spins until the condition holds, at most so long by the wall clock.
  static bool waitFor(const std::function<bool()>& condition, double seconds = 20.0) {
    const ros::WallTime end = ros::WallTime::now() + ros::WallDuration(seconds);
    while (ros::ok() && ros::WallTime::now() < end) {
      ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(0.02));
      if (condition()) return true;
    }
    return false;
  }
  static bool morePoses(const Instance& instance, int more = 20) {
    return waitFor([&instance, wanted = instance.poses + more] { return instance.poses >= wanted; });
  }

  static std::string rig_;
  pluginlib::ClassLoader<nodelet::Nodelet> plugins_;
  nodelet::Loader manager_;
};

std::string NodeletManager::rig_;

TEST_F(NodeletManager, ImagesReachTheWorkerUncopied) {
  Instance a("uncopied");
  ASSERT_TRUE(load(a.nodelet));
  ASSERT_TRUE(loadCamera());
  ASSERT_TRUE(morePoses(a, 1));  // connected
  std::map<std::string, int> before = CameraNodelet::released();
  ASSERT_TRUE(morePoses(a));
  std::map<std::string, int> after = CameraNodelet::released();
  for (const auto& [thread, images] : after) {
    std::printf("%d images were last held by thread %s\n", images - before[thread], thread.c_str());
  }
  // Any thread may be preempted while it still holds an image. Of copies, the worker would never hold the original.
  EXPECT_GE(after["egomotion"] - before["egomotion"], 5);
  ASSERT_TRUE(manager_.clear());
  EXPECT_TRUE(waitFor([] { return CameraNodelet::held() == 0; }, 1.0)) << CameraNodelet::held();
}

TEST_F(NodeletManager, NeighboursDoNotDisturbEachOther) {
  Instance a("first"), b("second");
  const std::string waiting = "/waiting/egomotion", wrong = "/wrong/egomotion";
  std::string summary;
  ros::NodeHandle node;
  const boost::function<void(const diagnostic_msgs::DiagnosticArray::ConstPtr&)> receive =
      [&](const diagnostic_msgs::DiagnosticArray::ConstPtr& message) {
        for (const auto& status : message->status) {
          if (status.name.find("waiting") != std::string::npos) summary = status.message;
        }
      };
  const ros::Subscriber diagnostics = node.subscribe<diagnostic_msgs::DiagnosticArray>("/diagnostics", 10, receive);
  ros::param::set(wrong + "/solver", "8pt");

  ASSERT_TRUE(loadCamera());
  ASSERT_TRUE(load(waiting, false));  // for CameraInfo that nobody publishes
  ASSERT_TRUE(load(a.nodelet));
  EXPECT_FALSE(load(wrong));
  ASSERT_TRUE(load(b.nodelet));
  EXPECT_TRUE(morePoses(a));
  EXPECT_TRUE(morePoses(b));
  EXPECT_TRUE(waitFor([&] { return summary.find("waiting for CameraInfo") == 0; })) << summary;

  for (int round = 0; round < 5; ++round) {
    const ros::WallTime begin = ros::WallTime::now();
    ASSERT_TRUE(manager_.unload(b.nodelet));
    const double seconds = (ros::WallTime::now() - begin).toSec();
    std::printf("unloaded in %.2f s\n", seconds);
    EXPECT_LT(seconds, starved() ? 5.0 : 1.0);
    waitFor([] { return false; }, 0.2);  // what was under way
    const int poses = b.poses;
    EXPECT_TRUE(morePoses(a, 3)) << "round " << round;
    EXPECT_EQ(b.poses, poses);
    ASSERT_TRUE(load(b.nodelet));
    EXPECT_TRUE(morePoses(b, 3)) << "round " << round;
  }
  EXPECT_EQ(a.last_motion->odom_epoch, 0u);
  ASSERT_TRUE(manager_.clear());
  EXPECT_TRUE(waitFor([] { return CameraNodelet::held() == 0; }, 1.0)) << CameraNodelet::held();
}

TEST_F(NodeletManager, ReloadingGivesTheMemoryBack) {
  const char* wanted = std::getenv("MULTICAM_EGOMOTION_RELOADS");
  const int rounds = wanted ? std::max(4, std::atoi(wanted)) : 12;
  Instance a("reloaded");
  ASSERT_TRUE(loadCamera());
  std::vector<double> megabytes;  // of the process after each round, with the odometry unloaded
  for (int round = 0; round < rounds; ++round) {
    ASSERT_TRUE(load(a.nodelet)) << "round " << round;
    ASSERT_TRUE(morePoses(a, 5)) << "round " << round;
    ASSERT_TRUE(manager_.unload(a.nodelet));
    megabytes.push_back(allocatedMegabytes());
  }
  const double half = megabytes[rounds / 2], end = megabytes.back();
  std::printf("%.2f MB after the first of %d reloads, %.2f MB after half of them, %.2f MB after all\n", megabytes[0],
              rounds, half, end);
  // An odometry holds some 20 MB.
  EXPECT_LT(end - half, 1.0);
  ASSERT_TRUE(manager_.clear());
}

TEST_F(NodeletManager, ParametersChangeBetweenFrames) {
  Instance a("tuned");
  ros::param::set(a.nodelet + "/ransac/max_epipolar_error_px", 1.75);
  ASSERT_TRUE(load(a.nodelet));
  ASSERT_TRUE(loadCamera());
  ASSERT_TRUE(morePoses(a));
  ASSERT_GT(a.last_motion->tracks, 2u * 4u * 15u);

  const auto set = [&](const dynamic_reconfigure::Config& wanted) {
    dynamic_reconfigure::Reconfigure change;
    change.request.config = wanted;
    EXPECT_TRUE(ros::service::call(a.nodelet + "/tuning/set_parameters", change));
    return change.response.config;
  };
  const auto text = [](const std::string& name, const std::string& value) {
    dynamic_reconfigure::StrParameter parameter;
    parameter.name = name;
    parameter.value = value;
    return parameter;
  };
  const auto integer = [](const std::string& name, int value) {
    dynamic_reconfigure::IntParameter parameter;
    parameter.name = name;
    parameter.value = value;
    return parameter;
  };
  const auto found = [](const auto& parameters, const std::string& name) {
    for (const auto& parameter : parameters) {
      if (parameter.name == name) return parameter.value;
    }
    throw std::runtime_error("no parameter " + name);
  };

  const dynamic_reconfigure::Config initial = set(dynamic_reconfigure::Config());
  EXPECT_EQ(found(initial.doubles, "max_epipolar_error_px"), 1.75);
  EXPECT_EQ(found(initial.strs, "solver"), "auto");

  dynamic_reconfigure::Config wanted;
  wanted.strs = {text("solver", "4pt-axis")};
  wanted.ints = {integer("features_per_camera", 15)};
  const dynamic_reconfigure::Config changed = set(wanted);
  EXPECT_EQ(found(changed.strs, "solver"), "4pt-axis");
  EXPECT_EQ(found(changed.ints, "features_per_camera"), 15);
  // From two images into two images, of which the features of each camera are seen in both at most.
  EXPECT_TRUE(waitFor([&] { return a.last_motion->solver == "4pt-axis" && a.last_motion->tracks <= 2 * 4 * 15; }));
  int written = 0;
  EXPECT_TRUE(ros::param::get(a.nodelet + "/tracker/features_per_camera", written));
  EXPECT_EQ(written, 15);

  // Refused as a whole: the solver is none, the number of features alone would do.
  wanted.strs = {text("solver", "8pt")};
  wanted.ints = {integer("features_per_camera", 50)};
  const dynamic_reconfigure::Config refused = set(wanted);
  EXPECT_EQ(found(refused.strs, "solver"), "4pt-axis");
  EXPECT_EQ(found(refused.ints, "features_per_camera"), 15);
  EXPECT_TRUE(morePoses(a));
  EXPECT_EQ(a.last_motion->odom_epoch, 0u);
  ASSERT_TRUE(manager_.clear());
}

}  // namespace

int main(int argc, char** argv) {
  ros::init(argc, argv, "test_nodelet_manager");
  ::testing::InitGoogleTest(&argc, argv);
  const ros::NodeHandle node;  // keeps ROS running between the tests
  return RUN_ALL_TESTS();
}
