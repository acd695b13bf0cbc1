// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "multicam_egomotion/ros/transform_watch.h"

#include <ros/this_node.h>

namespace multicam_egomotion {
namespace {

std::string withoutSlash(const std::string& frame) { return frame.substr(!frame.empty() && frame[0] == '/' ? 1 : 0); }

}  // namespace

TransformWatch::TransformWatch(ros::NodeHandle node, const std::string& base_frame)
    : base_frame_(withoutSlash(base_frame)) {
  using Event = ros::MessageEvent<tf2_msgs::TFMessage const>;
  for (const bool is_static : {false, true}) {
    const boost::function<void(const Event&)> callback = [this, is_static](const Event& event) {
      receive(event, is_static);
    };
    subscribers_.push_back(node.subscribe<tf2_msgs::TFMessage>(is_static ? "/tf_static" : "/tf", 100, callback));
  }
}

void TransformWatch::receive(const ros::MessageEvent<tf2_msgs::TFMessage const>& event, bool is_static) {
  const std::string& publisher = event.getPublisherName();
  if (publisher == ros::this_node::getName()) return;
  for (const geometry_msgs::TransformStamped& transform : event.getConstMessage()->transforms) {
    if (withoutSlash(transform.child_frame_id) != base_frame_) continue;
    const std::lock_guard<std::mutex> lock(mutex_);
    others_[publisher] = {transform.header.frame_id, Clock::now(), is_static};
  }
}

std::vector<std::string> TransformWatch::conflicts() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  std::vector<std::string> lines;
  for (const auto& [publisher, other] : others_) {
    if (!other.is_static && Clock::now() - other.last > std::chrono::seconds(5)) continue;
    lines.push_back("TF " + other.parent + " -> " + base_frame_ + " comes from " + publisher +
                    " too, expected one publisher: publish_tf: false here, or stop the other");
  }
  return lines;
}

}  // namespace multicam_egomotion
