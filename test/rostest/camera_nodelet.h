// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <image_transport/image_transport.h>
#include <nodelet/nodelet.h>
#include <pthread.h>
#include <rosbag/bag.h>
#include <rosbag/view.h>
#include <sensor_msgs/Imu.h>

#include <atomic>
#include <chrono>
#include <map>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace multicam_egomotion {

/// Publishes images and IMU samples of a recording, again and again with stamps that go on, as the drivers of a rig
/// would; knows which thread was the last to hold each image.
class CameraNodelet : public nodelet::Nodelet {
 public:
  /// Images by the name of the thread that let go of them last.
  static std::map<std::string, int> released() {
    const std::lock_guard<std::mutex> lock(mutex_);
    return released_;
  }
  /// Images that someone still holds.
  static int held() { return held_; }
  /// Before it is loaded: the first `seconds` of a bag, and how fast to publish them (1 is real time).
  static void setRecording(const std::string& bag_path, double seconds, double rate) {
    const rosbag::Bag bag(bag_path, rosbag::bagmode::Read);
    rosbag::View all(bag);
    const ros::Time end = all.getBeginTime() + ros::Duration(seconds);
    for (const rosbag::MessageInstance& message :
         rosbag::View(bag, rosbag::TopicQuery(kTopics), all.getBeginTime(), end)) {
      recording_.push_back(
          {message.getTopic(), message.instantiate<sensor_msgs::Image>(), message.instantiate<sensor_msgs::Imu>()});
    }
    length_ = ros::Duration(seconds + 0.05);
    rate_ = rate;
  }

  ~CameraNodelet() override {
    running_ = false;
    if (thread_.joinable()) thread_.join();
  }

 private:
  struct Recorded {
    std::string topic;
    sensor_msgs::ImageConstPtr image;
    sensor_msgs::ImuConstPtr imu;
  };

  void onInit() override {
    image_transport::ImageTransport transport(getNodeHandle());
    for (const std::string& topic : kTopics) {
      if (topic == "/imu") continue;
      images_[topic] = transport.advertise(topic, 5);
    }
    imu_ = getNodeHandle().advertise<sensor_msgs::Imu>("/imu", 1000);
    thread_ = std::thread(&CameraNodelet::play, this);
  }

  void play() {
    pthread_setname_np(pthread_self(), "camera");
    const auto begin = std::chrono::steady_clock::now();
    const ros::Time first = stampOf(recording_.front());
    for (ros::Duration offset; running_; offset += length_) {
      for (const Recorded& one : recording_) {
        const ros::Duration since = stampOf(one) + offset - first;
        std::this_thread::sleep_until(begin + std::chrono::nanoseconds((since * (1.0 / rate_)).toNSec()));
        if (!running_) return;
        publish(one, stampOf(one) + offset);
      }
    }
  }

  void publish(const Recorded& one, const ros::Time& stamp) {
    if (one.imu) {
      const auto imu = boost::make_shared<sensor_msgs::Imu>(*one.imu);
      imu->header.stamp = stamp;
      imu_.publish(imu);
      return;
    }
    ++held_;
    const boost::shared_ptr<sensor_msgs::Image> image(new sensor_msgs::Image(*one.image), &CameraNodelet::release);
    image->header.stamp = stamp;
    images_[one.topic].publish(sensor_msgs::ImageConstPtr(image));
  }

  static ros::Time stampOf(const Recorded& one) { return one.image ? one.image->header.stamp : one.imu->header.stamp; }

  static void release(sensor_msgs::Image* image) {
    delete image;
    --held_;
    char name[16] = {};
    pthread_getname_np(pthread_self(), name, sizeof(name));
    const std::lock_guard<std::mutex> lock(mutex_);
    ++released_[name];
  }

  inline static const std::vector<std::string> kTopics = {"/cam0/image_raw", "/cam1/image_raw", "/imu"};
  inline static std::vector<Recorded> recording_;
  inline static ros::Duration length_;
  inline static double rate_ = 1.0;
  inline static std::mutex mutex_;
  inline static std::map<std::string, int> released_;
  inline static std::atomic<int> held_{0};

  std::map<std::string, image_transport::Publisher> images_;
  ros::Publisher imu_;
  std::atomic<bool> running_{true};
  std::thread thread_;
};

}  // namespace multicam_egomotion
