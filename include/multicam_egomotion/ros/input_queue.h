// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sensor_msgs/CompressedImage.h>
#include <sensor_msgs/Image.h>
#include <sensor_msgs/Imu.h>

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>
#include <optional>
#include <variant>

namespace multicam_egomotion {

using WallTime = std::chrono::steady_clock::time_point;

/// An image as it arrived; one of the two messages is set.
struct ImageInput {
  int camera = 0;
  sensor_msgs::ImageConstPtr raw;
  sensor_msgs::CompressedImageConstPtr compressed;
  WallTime arrival;
};

using Request = std::function<void()>;
using Input = std::variant<ImageInput, sensor_msgs::ImuConstPtr, Request>;

/// What the callbacks hand to the worker, in order of arrival (contract 12). Bounded: the oldest image, or the oldest
/// IMU sample, makes room and is counted. Requests go first. Once closed, what waits and what comes is destroyed.
/// Thread-safe.
class InputQueue {
 public:
  InputQueue(std::size_t max_images, std::size_t max_imu) : max_images_(max_images), max_imu_(max_imu) {}

  void push(ImageInput image);
  void push(sensor_msgs::ImuConstPtr sample);
  /// Runs in the worker before the next input.
  void post(Request request);
  /// The next input, or nothing after `timeout` and once closed.
  std::optional<Input> pop(std::chrono::milliseconds timeout);
  void close();

  std::uint64_t droppedImages() const;
  std::uint64_t droppedImu() const;

 private:
  template <class Kind>
  void pushBounded(Input input, std::size_t limit, std::size_t* count, std::uint64_t* dropped);

  const std::size_t max_images_, max_imu_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Input> inputs_;
  std::size_t images_ = 0, imu_ = 0;
  std::uint64_t dropped_images_ = 0, dropped_imu_ = 0;
  bool closed_ = false;
};

}  // namespace multicam_egomotion
