// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/message_event.h>
#include <ros/node_handle.h>
#include <tf2_msgs/TFMessage.h>

#include <chrono>
#include <map>
#include <mutex>
#include <string>
#include <vector>

namespace multicam_egomotion {

/// Notices other nodes that place the body frame in TF: a frame has one parent, and the tree would flip between them.
/// Nodelets of the same manager cannot be told apart. Thread-safe.
class TransformWatch {
 public:
  TransformWatch(ros::NodeHandle node, const std::string& base_frame);

  /// One line a node that did so within the last five seconds, or with a static transform.
  std::vector<std::string> conflicts() const;

 private:
  using Clock = std::chrono::steady_clock;

  void receive(const ros::MessageEvent<tf2_msgs::TFMessage const>& event, bool is_static);

  struct Other {
    std::string parent;
    Clock::time_point last;
    bool is_static;
  };

  const std::string base_frame_;
  std::vector<ros::Subscriber> subscribers_;
  mutable std::mutex mutex_;
  std::map<std::string, Other> others_;  // by name of the node
};

}  // namespace multicam_egomotion
