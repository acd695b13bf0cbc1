// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
// A recording replayed through the odometry: everything it publishes, against the recording's ground truth.
#include <diagnostic_msgs/DiagnosticArray.h>
#include <gtest/gtest.h>
#include <multicam_egomotion/EgoMotion.h>
#include <nav_msgs/Odometry.h>
#include <nav_msgs/Path.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <sensor_msgs/Image.h>
#include <sensor_msgs/PointCloud2.h>
#include <tf2_msgs/TFMessage.h>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <map>
#include <set>

namespace {

using multicam_egomotion::EgoMotion;
using Covariance = Eigen::Matrix<double, 6, 6>;

Eigen::Vector3d position(const geometry_msgs::Pose& pose) {
  return {pose.position.x, pose.position.y, pose.position.z};
}

/// Everything that was published while the bag played.
struct Recording {
  std::set<ros::Time> image_stamps;
  std::map<ros::Time, nav_msgs::Odometry> odometry, relative_pose, ground_truth;
  std::map<ros::Time, EgoMotion> ego_motion;
  std::map<ros::Time, geometry_msgs::TransformStamped> transforms;
  std::vector<diagnostic_msgs::DiagnosticStatus> diagnostics;
  nav_msgs::Path path;
  sensor_msgs::PointCloud2 points;
  sensor_msgs::Image features;
  ros::WallTime last_odometry;
};

class Replay : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    ros::NodeHandle node, private_node("~");
    private_node.param("max_error", max_error_, 0.05);
    private_node.param("min_answered", min_answered_, 0.9);
    private_node.param<std::string>("base_frame", base_frame_, "base_link");
    const auto keep = [](auto& map) { return [&map](const auto& message) { map[message->header.stamp] = *message; }; };
    using nav_msgs::Odometry;
    const boost::function<void(const Odometry::ConstPtr&)> odometry = [](const Odometry::ConstPtr& message) {
      recording_.odometry[message->header.stamp] = *message;
      recording_.last_odometry = ros::WallTime::now();
    };
    const boost::function<void(const Odometry::ConstPtr&)> relative = keep(recording_.relative_pose);
    const boost::function<void(const Odometry::ConstPtr&)> truth = keep(recording_.ground_truth);
    const boost::function<void(const EgoMotion::ConstPtr&)> motion = keep(recording_.ego_motion);
    const boost::function<void(const sensor_msgs::Image::ConstPtr&)> image =
        [](const sensor_msgs::Image::ConstPtr& message) { recording_.image_stamps.insert(message->header.stamp); };
    const boost::function<void(const tf2_msgs::TFMessage::ConstPtr&)> tf =
        [](const tf2_msgs::TFMessage::ConstPtr& message) {
          for (const auto& transform : message->transforms) {
            if (transform.child_frame_id == base_frame_) recording_.transforms[transform.header.stamp] = transform;
          }
        };
    const boost::function<void(const diagnostic_msgs::DiagnosticArray::ConstPtr&)> diagnostics =
        [](const diagnostic_msgs::DiagnosticArray::ConstPtr& message) {
          for (const auto& status : message->status) recording_.diagnostics.push_back(status);
        };
    const boost::function<void(const nav_msgs::Path::ConstPtr&)> path = [](const nav_msgs::Path::ConstPtr& message) {
      recording_.path = *message;
    };
    const boost::function<void(const sensor_msgs::PointCloud2::ConstPtr&)> points =
        [](const sensor_msgs::PointCloud2::ConstPtr& message) {
          if (message->width > 0) recording_.points = *message;
        };
    const boost::function<void(const sensor_msgs::Image::ConstPtr&)> features =
        [](const sensor_msgs::Image::ConstPtr& message) { recording_.features = *message; };
    const std::vector<ros::Subscriber> subscribers = {
        node.subscribe<Odometry>("odometry", 1000, odometry),
        node.subscribe<Odometry>("relative_pose", 1000, relative),
        node.subscribe<EgoMotion>("ego_motion", 1000, motion),
        node.subscribe<Odometry>("ground_truth", 10000, truth),
        node.subscribe<sensor_msgs::Image>("cam0/image_raw", 100, image),
        node.subscribe<tf2_msgs::TFMessage>("/tf", 1000, tf),
        node.subscribe<diagnostic_msgs::DiagnosticArray>("/diagnostics", 100, diagnostics),
        node.subscribe<nav_msgs::Path>("path", 10, path),
        node.subscribe<sensor_msgs::PointCloud2>("points", 100, points),
        node.subscribe<sensor_msgs::Image>("features", 100, features),
    };
    // Until the odometry has been silent for 3 s, at most 120 s, in wall time: simulated time ends with the bag.
    const ros::WallTime begin = ros::WallTime::now();
    recording_.last_odometry = begin + ros::WallDuration(40.0);
    while (ros::ok() && ros::WallTime::now() - recording_.last_odometry < ros::WallDuration(3.0) &&
           ros::WallTime::now() - begin < ros::WallDuration(120.0)) {
      ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(0.05));
    }
  }

  static Recording recording_;
  static double max_error_, min_answered_;
  static std::string base_frame_;
};

Recording Replay::recording_;
double Replay::max_error_, Replay::min_answered_;
std::string Replay::base_frame_;

void expectCovariance(const boost::array<double, 36>& values) {
  const Covariance covariance = Eigen::Map<const Covariance>(values.data());
  EXPECT_TRUE(covariance.isApprox(covariance.transpose()));
  EXPECT_EQ(covariance.llt().info(), Eigen::Success);
  EXPECT_GE(covariance.diagonal().minCoeff(), 1e-10);
  EXPECT_LE(covariance.diagonal().maxCoeff(), 1e6);
}

TEST_F(Replay, AnswersTheImages) {
  ASSERT_GT(recording_.image_stamps.size(), 20u);
  EXPECT_GE(recording_.odometry.size(), min_answered_ * recording_.image_stamps.size());
  EXPECT_GE(recording_.relative_pose.size() + 1, min_answered_ * recording_.image_stamps.size());
  EXPECT_GE(recording_.ego_motion.size(), recording_.odometry.size());
}

TEST_F(Replay, StampsAreThoseOfTheImages) {
  for (const auto& [stamp, message] : recording_.ego_motion) {
    if (message.status == EgoMotion::COASTING) continue;  // after the last image, at the time of the IMU
    EXPECT_EQ(recording_.image_stamps.count(stamp), 1u);
    EXPECT_EQ(recording_.odometry.count(stamp), 1u);
    if (message.has_relative_pose) {
      EXPECT_EQ(recording_.image_stamps.count(message.previous_stamp), 1u);
      EXPECT_LT(message.previous_stamp, stamp);
    }
  }
}

TEST_F(Replay, FramesAndCovariances) {
  ASSERT_FALSE(recording_.odometry.empty());
  for (const auto& [stamp, message] : recording_.odometry) {
    EXPECT_EQ(message.header.frame_id, "odom");
    EXPECT_EQ(message.child_frame_id, base_frame_);
    expectCovariance(message.pose.covariance);
    expectCovariance(message.twist.covariance);
  }
  for (const auto& [stamp, message] : recording_.relative_pose) {
    EXPECT_EQ(message.header.frame_id, base_frame_ + "_previous");
    EXPECT_EQ(message.child_frame_id, base_frame_);
    expectCovariance(message.pose.covariance);
  }
}

TEST_F(Replay, TransformIsTheOdometry) {
  std::size_t compared = 0;
  for (const auto& [stamp, message] : recording_.odometry) {
    const auto transform = recording_.transforms.find(stamp);
    if (transform == recording_.transforms.end()) continue;
    ++compared;
    EXPECT_EQ(transform->second.header.frame_id, "odom");
    EXPECT_EQ(transform->second.transform.translation.x, message.pose.pose.position.x);
    EXPECT_EQ(transform->second.transform.translation.y, message.pose.pose.position.y);
    EXPECT_EQ(transform->second.transform.translation.z, message.pose.pose.position.z);
    EXPECT_TRUE(transform->second.transform.rotation == message.pose.pose.orientation);
  }
  EXPECT_GE(compared, 0.9 * recording_.odometry.size());
}

TEST_F(Replay, FollowsTheGroundTruth) {
  // Position and yaw are free; roll and pitch are not: odom is level.
  std::vector<Eigen::Vector3d> estimated, truth;
  for (const auto& [stamp, message] : recording_.odometry) {
    const auto after = recording_.ground_truth.lower_bound(stamp);
    if (after == recording_.ground_truth.end() || after == recording_.ground_truth.begin()) continue;
    const auto before = std::prev(after);
    const double share = (stamp - before->first).toSec() / (after->first - before->first).toSec();
    truth.push_back((1.0 - share) * position(before->second.pose.pose) + share * position(after->second.pose.pose));
    estimated.push_back(position(message.pose.pose));
  }
  ASSERT_GT(truth.size(), 20u);
  Eigen::Vector3d estimated_mean = Eigen::Vector3d::Zero(), truth_mean = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < truth.size(); ++i) {
    estimated_mean += estimated[i] / static_cast<double>(truth.size());
    truth_mean += truth[i] / static_cast<double>(truth.size());
  }
  double cosine = 0.0, sine = 0.0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const Eigen::Vector3d a = estimated[i] - estimated_mean, b = truth[i] - truth_mean;
    cosine += a.x() * b.x() + a.y() * b.y();
    sine += a.x() * b.y() - a.y() * b.x();
  }
  const Eigen::AngleAxisd yaw(std::atan2(sine, cosine), Eigen::Vector3d::UnitZ());
  double sum = 0.0, path = 0.0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    sum += (yaw * (estimated[i] - estimated_mean) - (truth[i] - truth_mean)).squaredNorm();
    if (i > 0) path += (truth[i] - truth[i - 1]).norm();
  }
  const double error = std::sqrt(sum / static_cast<double>(truth.size()));
  RecordProperty("ate_mm", static_cast<int>(1e3 * error));
  std::printf("ATE %.4f m over %.2f m, %zu poses\n", error, path, truth.size());
  EXPECT_GT(path, 1.0);
  EXPECT_LT(error, max_error_);
}

TEST_F(Replay, DiagnosticsTellTheState) {
  std::map<std::string, std::string> values;
  bool tracking = false;
  for (const auto& status : recording_.diagnostics) {
    if (status.name != "egomotion: odometry") continue;
    tracking = tracking || status.level == diagnostic_msgs::DiagnosticStatus::OK;
    for (const auto& value : status.values) values[value.key] = value.value;
  }
  EXPECT_TRUE(tracking);
  for (const char* key : {"status", "rate [Hz]", "latency median [ms]", "tracks", "inlier ratio", "scale state",
                          "IMU state", "cam1 rotation", "dropped images"}) {
    EXPECT_EQ(values.count(key), 1u) << key;
  }
}

TEST_F(Replay, PicturesForRviz) {
  EXPECT_EQ(recording_.path.header.frame_id, "odom");
  EXPECT_GT(recording_.path.poses.size(), 2u);
  EXPECT_EQ(recording_.points.header.frame_id, "odom");
  EXPECT_GT(recording_.points.width, 0u);
  EXPECT_EQ(recording_.features.encoding, "bgr8");
}

}  // namespace

int main(int argc, char** argv) {
  ros::init(argc, argv, "test_replay");
  ::testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
