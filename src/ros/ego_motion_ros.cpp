// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "multicam_egomotion/ros/ego_motion_ros.h"

#include <ros/console.h>

#include <future>
#include <stdexcept>

namespace multicam_egomotion {
namespace {

constexpr std::size_t kQueuedSets = 3;
constexpr std::size_t kQueuedImuSamples = 5000;  // 5 s at 1 kHz

/// The name in the parameters or the rig file, unless the topic was remapped.
std::string chosenTopic(const ros::NodeHandle& node, const std::string& standard, const std::string& named) {
  const bool remapped = node.resolveName(standard, true) != node.resolveName(standard, false);
  return node.resolveName(remapped ? standard : named);
}

}  // namespace

EgoMotionRos::EgoMotionRos(ros::NodeHandle node, ros::NodeHandle private_node)
    : node_(node), private_node_(private_node) {
  node_.setCallbackQueue(&callbacks_);
  private_node_.setCallbackQueue(&callbacks_);
  const std::string tuning = std::string(LiveParameters::kNamespace) + "/";
  for (const std::string& name : applyParameters(readParameterServer(private_node_), &parameters_)) {
    if (name.compare(0, tuning.size(), tuning) == 0) continue;  // of an earlier run
    ROS_WARN("%s: '%s' is no parameter of multicam_egomotion and has no effect", private_node_.getNamespace().c_str(),
             name.c_str());
  }
  topics_ = defaultTopics(parameters_.node.cameras, parameters_.node.base_frame);
  if (!parameters_.node.rig_file.empty()) setup_ = loadRigSetup(parameters_, &topics_);
  const RigTopics standard = defaultTopics(static_cast<int>(topics_.images.size()), topics_.base_frame);
  for (std::size_t i = 0; i < topics_.images.size(); ++i) {
    topics_.images[i] = chosenTopic(node_, standard.images[i], topics_.images[i]);
    topics_.camera_infos[i] = chosenTopic(node_, standard.camera_infos[i], topics_.camera_infos[i]);
  }
  topics_.imu = chosenTopic(node_, standard.imu, topics_.imu);

  const FrameNames frames{parameters_.node.odom_frame, topics_.base_frame};
  queue_ = std::make_unique<InputQueue>(kQueuedSets * topics_.images.size(), kQueuedImuSamples);
  publishers_ = std::make_unique<Publishers>(node_, frames, parameters_.node);
  diagnostics_ = std::make_unique<Diagnostics>(node_, private_node_);
  diagnostics_->health().use_imu = parameters_.odometry.use_imu;
  paused_ = parameters_.node.start_paused;
  if (setup_) {
    start(*setup_);
  } else {
    acquisition_ = std::make_unique<RigAcquisition>(node_, topics_, parameters_);
  }
  subscribe();
  live_parameters_ = std::make_unique<LiveParameters>(private_node_, parameters_,
                                                      [this](const Parameters& wanted) { return tune(wanted); });
  if (parameters_.node.publish_tf) transform_watch_ = std::make_unique<TransformWatch>(node_, topics_.base_frame);
  spinner_ = std::make_unique<ros::AsyncSpinner>(2, &callbacks_);  // one may be waiting for a request to be served
  spinner_->start();
  worker_ = std::thread(&EgoMotionRos::work, this);
}

EgoMotionRos::~EgoMotionRos() {
  running_ = false;
  queue_->close();
  if (worker_.joinable()) worker_.join();
  spinner_->stop();
}

void EgoMotionRos::subscribe() {
  transport_ = std::make_unique<image_transport::ImageTransport>(node_);
  for (std::size_t i = 0; i < topics_.images.size(); ++i) {
    subscribeImage(static_cast<int>(i), topics_.images[i]);
    watch_.add(topics_.images[i], [this, i] {
      return i < image_subscribers_.size() ? image_subscribers_[i].getNumPublishers()
                                           : subscribers_[i].getNumPublishers();
    });
  }
  if (parameters_.odometry.use_imu) {
    const std::size_t watched = topics_.images.size();
    const boost::function<void(const sensor_msgs::ImuConstPtr&)> callback =
        [this, watched](const sensor_msgs::ImuConstPtr& message) {
          watch_.note(watched);
          queue_->push(message);
        };
    subscribers_.push_back(
        node_.subscribe<sensor_msgs::Imu>(topics_.imu, 1000, callback, nullptr, ros::TransportHints().tcpNoDelay()));
    watch_.add(topics_.imu, [imu = subscribers_.size() - 1, this] { return subscribers_[imu].getNumPublishers(); });
  }
  services_.push_back(private_node_.advertiseService("reset", &EgoMotionRos::reset, this));
  services_.push_back(private_node_.advertiseService("set_pose", &EgoMotionRos::setPose, this));
  services_.push_back(private_node_.advertiseService("pause", &EgoMotionRos::pause, this));
  services_.push_back(private_node_.advertiseService("resume", &EgoMotionRos::resume, this));
}

void EgoMotionRos::subscribeImage(int camera, const std::string& topic) {
  const auto receive = [this, camera](ImageInput input) {
    watch_.note(camera);
    input.camera = camera;
    input.arrival = std::chrono::steady_clock::now();
    queue_->push(std::move(input));
  };
  if (parameters_.node.image_transport == "compressed") {
    const boost::function<void(const sensor_msgs::CompressedImageConstPtr&)> callback =
        [receive](const sensor_msgs::CompressedImageConstPtr& image) {
          receive({0, nullptr, image, {}});
        };
    subscribers_.push_back(node_.subscribe<sensor_msgs::CompressedImage>(topic + "/compressed", 5, callback));
    return;
  }
  const boost::function<void(const sensor_msgs::ImageConstPtr&)> callback =
      [receive](const sensor_msgs::ImageConstPtr& image) {
        receive({0, image, nullptr, {}});
      };
  const image_transport::TransportHints hints(parameters_.node.image_transport, ros::TransportHints().tcpNoDelay(),
                                              private_node_);
  try {
    image_subscribers_.push_back(transport_->subscribe(topic, 5, callback, ros::VoidPtr(), hints));
  } catch (const image_transport::Exception& error) {
    throw std::invalid_argument("parameter 'image_transport': " + std::string(error.what()));
  }
}

std::string EgoMotionRos::inWorker(std::function<std::string()> request) {
  auto done = std::make_shared<std::promise<std::string>>();
  std::future<std::string> answer = done->get_future();
  queue_->post([request = std::move(request), done = std::move(done)] {
    try {
      done->set_value(request());
    } catch (const std::exception& error) {
      done->set_value(error.what());
    }
  });
  if (answer.wait_for(std::chrono::seconds(5)) != std::future_status::ready) return "not served within 5 s";
  try {
    return answer.get();
  } catch (const std::future_error&) {  // the queue was closed
    return "the odometry is shutting down";
  }
}

std::string EgoMotionRos::serve(std::function<void(EgoMotion&)> request) {
  return inWorker([this, request = std::move(request)]() -> std::string {
    if (odometry_ == nullptr) return "the rig is not known yet";
    request(*odometry_);
    return "";
  });
}

std::string EgoMotionRos::tune(const Parameters& wanted) {
  return inWorker([this, wanted]() -> std::string {
    if (odometry_ != nullptr) odometry_->tune(wanted.odometry);
    parameters_.odometry = wanted.odometry;  // for a rig that is not known yet
    publishers_->show(wanted.node.publish_features, wanted.node.publish_points);
    return "";
  });
}

bool EgoMotionRos::reset(std_srvs::Trigger::Request&, std_srvs::Trigger::Response& response) {
  const bool forget_biases = parameters_.node.forget_biases;
  response.message = serve([forget_biases](EgoMotion& odometry) { odometry.reset(forget_biases); });
  response.success = response.message.empty();
  return true;
}

bool EgoMotionRos::setPose(SetPose::Request& request, SetPose::Response& response) {
  if (!isRigid(request.pose)) {
    response.message = "the pose is not finite, or its quaternion not of norm 1";
  } else {
    const Eigen::Isometry3d pose = toIsometry(request.pose);
    response.message = serve([pose](EgoMotion& odometry) { odometry.setPose(pose); });
  }
  response.success = response.message.empty();
  return true;
}

bool EgoMotionRos::pause(std_srvs::Trigger::Request&, std_srvs::Trigger::Response& response) {
  response.success = !paused_.exchange(true);
  if (!response.success) response.message = "was paused already";
  return true;
}

bool EgoMotionRos::resume(std_srvs::Trigger::Request&, std_srvs::Trigger::Response& response) {
  response.success = paused_.exchange(false);
  if (!response.success) response.message = "was not paused";
  return true;
}

}  // namespace multicam_egomotion
