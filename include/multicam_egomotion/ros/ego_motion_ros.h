// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <image_transport/image_transport.h>
#include <multicam_egomotion/SetPose.h>
#include <ros/callback_queue.h>
#include <ros/node_handle.h>
#include <ros/spinner.h>
#include <std_srvs/Trigger.h>

#include <atomic>
#include <memory>
#include <thread>

#include "multicam_egomotion/odometry/ego_motion.h"
#include "multicam_egomotion/ros/data_clock.h"
#include "multicam_egomotion/ros/diagnostics.h"
#include "multicam_egomotion/ros/input_queue.h"
#include "multicam_egomotion/ros/live_parameters.h"
#include "multicam_egomotion/ros/publishers.h"
#include "multicam_egomotion/ros/rig_acquisition.h"
#include "multicam_egomotion/ros/topic_watch.h"
#include "multicam_egomotion/ros/transform_watch.h"

namespace multicam_egomotion {

/// The odometry on ROS topics: what the nodelet and the node wrap. Callbacks, on threads of its own, only queue; one
/// worker runs the odometry, publishes and serves requests between frames (contract 12).
class EgoMotionRos {
 public:
  /// Subscribes and starts; throws std::invalid_argument on wrong parameters or a wrong rig file.
  EgoMotionRos(ros::NodeHandle node, ros::NodeHandle private_node);
  ~EgoMotionRos();

  /// The configuration turned out wrong after the start (a CameraInfo that cannot be); diagnostics say why.
  bool configurationFailed() const { return configuration_failed_; }

 private:
  void subscribe();
  void subscribeImage(int camera, const std::string& topic);
  bool reset(std_srvs::Trigger::Request& request, std_srvs::Trigger::Response& response);
  bool setPose(SetPose::Request& request, SetPose::Response& response);
  bool pause(std_srvs::Trigger::Request& request, std_srvs::Trigger::Response& response);
  bool resume(std_srvs::Trigger::Request& request, std_srvs::Trigger::Response& response);
  /// Run in the worker and wait for it; the answer says why nothing was done, empty on success.
  std::string inWorker(std::function<std::string()> request);
  std::string serve(std::function<void(EgoMotion&)> request);
  std::string tune(const Parameters& wanted);

  void work();
  void acquireRig();
  void start(const RigSetup& setup);
  void process(const Input& input);
  void process(const sensor_msgs::Imu& message);
  void process(const ImageInput& input);
  void publish(const std::vector<EgoMotionResult>& results);
  void report();
  void warn();

  ros::CallbackQueue callbacks_;
  ros::NodeHandle node_, private_node_;
  Parameters parameters_;
  RigTopics topics_;
  std::optional<RigSetup> setup_;
  std::unique_ptr<RigAcquisition> acquisition_;  // without a rig file
  std::unique_ptr<InputQueue> queue_;
  TopicWatch watch_;

  // Of the worker.
  std::unique_ptr<EgoMotion> odometry_;
  std::deque<sensor_msgs::ImuConstPtr> early_imu_;  // before the rig was known
  DataClock clock_;
  std::unique_ptr<RecentImages> recent_images_;
  std::unique_ptr<Publishers> publishers_;
  std::unique_ptr<Diagnostics> diagnostics_;
  TopicWatch::Clock::time_point warned_, last_frame_;
  std::string input_fault_;  // the newest since the last report

  std::unique_ptr<image_transport::ImageTransport> transport_;
  std::vector<image_transport::Subscriber> image_subscribers_;
  std::vector<ros::Subscriber> subscribers_;
  std::vector<ros::ServiceServer> services_;
  std::unique_ptr<LiveParameters> live_parameters_;
  std::unique_ptr<TransformWatch> transform_watch_;  // where the transform is published here
  std::unique_ptr<ros::AsyncSpinner> spinner_;
  /// Images are ignored and nothing is published; the IMU carries the state on.
  std::atomic<bool> paused_{false};
  std::atomic<bool> running_{true}, configuration_failed_{false};
  std::thread worker_;
};

}  // namespace multicam_egomotion
