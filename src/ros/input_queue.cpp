// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "multicam_egomotion/ros/input_queue.h"

#include <algorithm>
#include <utility>

namespace multicam_egomotion {

template <class Kind>
void InputQueue::pushBounded(Input input, std::size_t limit, std::size_t* count, std::uint64_t* dropped) {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (closed_) return;
    if (*count == limit) {
      inputs_.erase(std::find_if(inputs_.begin(), inputs_.end(),
                                 [](const Input& waiting) { return std::holds_alternative<Kind>(waiting); }));
      --*count;
      ++*dropped;
    }
    inputs_.push_back(std::move(input));
    ++*count;
  }
  changed_.notify_one();
}

void InputQueue::push(ImageInput image) {
  pushBounded<ImageInput>(std::move(image), max_images_, &images_, &dropped_images_);
}

void InputQueue::push(sensor_msgs::ImuConstPtr sample) {
  pushBounded<sensor_msgs::ImuConstPtr>(std::move(sample), max_imu_, &imu_, &dropped_imu_);
}

void InputQueue::post(Request request) {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (closed_) return;
    inputs_.push_front(std::move(request));
  }
  changed_.notify_one();
}

std::optional<Input> InputQueue::pop(std::chrono::milliseconds timeout) {
  std::unique_lock<std::mutex> lock(mutex_);
  changed_.wait_for(lock, timeout, [this] { return closed_ || !inputs_.empty(); });
  if (closed_ || inputs_.empty()) return std::nullopt;
  Input input = std::move(inputs_.front());
  inputs_.pop_front();
  if (std::holds_alternative<ImageInput>(input)) --images_;
  if (std::holds_alternative<sensor_msgs::ImuConstPtr>(input)) --imu_;
  return input;
}

void InputQueue::close() {
  std::deque<Input> unserved;  // ends outside of the lock
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    closed_ = true;
    unserved.swap(inputs_);
  }
  changed_.notify_all();
}

std::uint64_t InputQueue::droppedImages() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return dropped_images_;
}

std::uint64_t InputQueue::droppedImu() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return dropped_imu_;
}

}  // namespace multicam_egomotion
