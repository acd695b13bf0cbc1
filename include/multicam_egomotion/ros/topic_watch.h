// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <functional>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

namespace multicam_egomotion {

/// Knows for how long each input topic has been silent, in wall time. Thread-safe.
class TopicWatch {
 public:
  using Clock = std::chrono::steady_clock;

  /// Before any note(); `publishers` tells how many there are.
  void add(const std::string& topic, std::function<unsigned()> publishers) {
    topics_.push_back({topic, std::move(publishers), Clock::now(), false});
  }

  void note(std::size_t topic) {
    const std::lock_guard<std::mutex> lock(mutex_);
    topics_[topic].last = Clock::now();
    topics_[topic].seen = true;
  }

  /// Topics without a message for two seconds, with how long: "/imu (3 s)", "/cam1/image_raw (never,
  /// no publisher)".
  std::vector<std::string> silent() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    std::vector<std::string> result;
    for (const Topic& topic : topics_) {
      const auto silence = std::chrono::duration_cast<std::chrono::seconds>(Clock::now() - topic.last).count();
      if (silence < 2) continue;
      result.push_back(topic.name + " (" + (topic.seen ? std::to_string(silence) + " s" : "never") +
                       (topic.publishers() == 0 ? ", no publisher)" : ")"));
    }
    return result;
  }

 private:
  struct Topic {
    std::string name;
    std::function<unsigned()> publishers;
    Clock::time_point last;
    bool seen;
  };

  mutable std::mutex mutex_;
  std::vector<Topic> topics_;
};

}  // namespace multicam_egomotion
