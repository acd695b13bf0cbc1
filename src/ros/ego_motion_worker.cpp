// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
// The worker thread of EgoMotionRos.
#include <pthread.h>
#include <ros/console.h>

#include <sstream>
#include <stdexcept>
#include <utility>

#include "multicam_egomotion/ros/ego_motion_ros.h"
#include "multicam_egomotion/ros/image_conversion.h"

namespace multicam_egomotion {
namespace {

constexpr std::size_t kEarlyImuSamples = 2000;
constexpr auto kWarningPeriod = std::chrono::seconds(5);

}  // namespace

void EgoMotionRos::work() {
  pthread_setname_np(pthread_self(), "egomotion");  // as `top -H` shows it
  while (running_ && !configuration_failed_) {
    if (odometry_ == nullptr) acquireRig();
    const std::optional<Input> input = queue_->pop(std::chrono::milliseconds(100));
    try {
      if (input) process(*input);
    } catch (const std::exception& error) {
      ++diagnostics_->health().internal_errors;
      input_fault_ = error.what();
    }
    if (diagnostics_->due()) report();
  }
  // A shared nodelet manager lives on; this instance only keeps saying what is wrong.
  while (running_) {
    if (diagnostics_->due()) report();
    if (const std::optional<Input> input = queue_->pop(std::chrono::milliseconds(100))) {
      if (std::holds_alternative<Request>(*input)) std::get<Request> (*input)();
    }
  }
}

void EgoMotionRos::acquireRig() {
  try {
    if (const std::optional<RigSetup> setup = acquisition_->tryBuild(&diagnostics_->health().message)) start(*setup);
  } catch (const std::invalid_argument& error) {
    diagnostics_->health().state = Health::State::kConfigError;
    diagnostics_->health().message = error.what();
    ROS_FATAL("%s: %s", private_node_.getNamespace().c_str(), error.what());
    report();
    configuration_failed_ = true;
  }
}

void EgoMotionRos::start(const RigSetup& setup) {
  odometry_ = makeEgoMotion(setup, parameters_);
  recent_images_ = std::make_unique<RecentImages>(setup.rig.size());
  diagnostics_->health().state = Health::State::kRunning;
  diagnostics_->health().message.clear();
  last_frame_ = TopicWatch::Clock::now();
  for (const sensor_msgs::ImuConstPtr& sample : early_imu_) process(*sample);
  early_imu_.clear();
  ROS_INFO("%s: %d cameras, body frame %s", private_node_.getNamespace().c_str(), setup.rig.size(),
           topics_.base_frame.c_str());
}

void EgoMotionRos::process(const Input& input) {
  if (std::holds_alternative<Request>(input)) {
    std::get<Request>(input)();
  } else if (std::holds_alternative<ImageInput>(input)) {
    if (odometry_ != nullptr && !paused_) process(std::get<ImageInput>(input));
  } else if (odometry_ != nullptr) {
    process(*std::get<sensor_msgs::ImuConstPtr>(input));
  } else {
    const sensor_msgs::ImuConstPtr& sample = std::get<sensor_msgs::ImuConstPtr>(input);
    acquisition_->setImuFrame(sample->header.frame_id);
    early_imu_.push_back(sample);
    if (early_imu_.size() > kEarlyImuSamples) early_imu_.pop_front();
  }
}

void EgoMotionRos::process(const sensor_msgs::Imu& message) {
  const ImuSample sample = toImuSample(message);
  odometry_->addImu(sample);
  publish(odometry_->advance(clock_.advance(sample.stamp_ns)));
  if (!paused_ && publishers_->wantsImuOdometry()) {
    if (const auto prediction = odometry_->predictToLatestImu()) publishers_->publishImuOdometry(*prediction);
  }
}

void EgoMotionRos::process(const ImageInput& input) {
  CameraImage image;
  image.camera = input.camera;
  try {
    image.grey = input.raw ? greyPixels(*input.raw) : greyPixels(*input.compressed);
  } catch (const std::invalid_argument& error) {
    ++diagnostics_->health().undecodable_images;
    input_fault_ = topics_.images[input.camera] + ": " + error.what();
    return;
  }
  image.stamp_ns = toNanoseconds(input.raw ? input.raw->header.stamp : input.compressed->header.stamp);
  recent_images_->add(image, input.arrival);
  const std::int64_t now_ns = clock_.advance(image.stamp_ns);
  odometry_->addImage(image, now_ns);
  publish(odometry_->advance(now_ns));
}

void EgoMotionRos::publish(const std::vector<EgoMotionResult>& results) {
  if (!results.empty()) last_frame_ = TopicWatch::Clock::now();
  if (paused_) return;
  for (const EgoMotionResult& result : results) {
    publishers_->publish(result, odometry_->rig(), *recent_images_);
    publishers_->publishCalibration(*odometry_, result.stamp_ns);
    std::optional<double> latency_ms;
    if (const auto arrival = recent_images_->lastArrival(result)) {
      latency_ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - *arrival).count();
    }
    diagnostics_->noteResult(result, latency_ms);
  }
}

void EgoMotionRos::report() {
  Health& health = diagnostics_->health();
  health.silent_topics = watch_.silent();
  health.paused = paused_;
  health.dropped_images = queue_->droppedImages();
  health.dropped_imu = queue_->droppedImu();
  if (acquisition_ != nullptr) health.changed_camera_infos = acquisition_->changes();
  health.faults.clear();
  health.cameras.clear();
  if (odometry_ != nullptr) {
    health.counters = odometry_->counters();
    health.faults = odometry_->faults();
    health.gyroscope_check = odometry_->gyroscopeCheck();
    health.calibration = odometry_->calibration();
    for (const RigCamera& camera : odometry_->rig().cameras()) health.cameras.push_back(camera.name);
  }
  if (!input_fault_.empty()) health.faults.push_back(std::exchange(input_fault_, ""));
  if (transform_watch_ != nullptr) {
    for (std::string& conflict : transform_watch_->conflicts()) health.faults.push_back(std::move(conflict));
  }
  diagnostics_->publish();
  if (health.state != Health::State::kConfigError) warn();
}

// What is missing or wrong, every five seconds.
void EgoMotionRos::warn() {
  const auto now = TopicWatch::Clock::now();
  if (now - warned_ < kWarningPeriod) return;
  const Health& health = diagnostics_->health();
  std::vector<std::string> lines = health.faults;
  const bool waiting = health.state == Health::State::kWaiting;
  if (waiting && !health.message.empty()) lines.push_back("waiting for " + health.message);
  if (!health.silent_topics.empty()) {
    std::string silent;
    for (const std::string& topic : health.silent_topics) silent += (silent.empty() ? "" : ", ") + topic;
    lines.push_back("no data on " + silent);
  } else if (lines.empty() && !waiting && !health.paused && now - last_frame_ >= kWarningPeriod) {
    std::ostringstream text;
    text << "no new frame, although data arrive: " << health.counters.rejected_images << " images rejected, "
         << health.undecodable_images << " not decodable, " << health.counters.late_images << " late; "
         << health.counters.rejected_imu << " IMU samples rejected";
    lines.push_back(text.str());
  }
  for (const std::string& line : lines) ROS_WARN("%s: %s", private_node_.getNamespace().c_str(), line.c_str());
  if (!lines.empty()) warned_ = now;
}

}  // namespace multicam_egomotion
