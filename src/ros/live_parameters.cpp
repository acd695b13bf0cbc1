// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "multicam_egomotion/ros/live_parameters.h"

#include <dynamic_reconfigure/server.h>
#include <multicam_egomotion/EgoMotionConfig.h>
#include <ros/console.h>

#include <stdexcept>
#include <utility>

#include "parameter_list.h"

namespace multicam_egomotion {
namespace {

constexpr std::uint32_t kAtStart = ~0u;  // level of dynamic_reconfigure's first call, which changes nothing

EgoMotionConfig toConfig(const Parameters& parameters) {
  EgoMotionConfig config = EgoMotionConfig::__getDefault__();
  config.features_per_camera = parameters.odometry.tracker.features_per_camera;
  config.fast_threshold = parameters.odometry.tracker.fast_threshold;
  config.max_epipolar_error_px = parameters.odometry.ransac.max_epipolar_error_px;
  config.solver = parameters.odometry.solver;
  config.publish_features = parameters.node.publish_features;
  config.publish_points = parameters.node.publish_points;
  return config;
}

ParameterMap toValues(const EgoMotionConfig& config) {
  ParameterMap values;
  values["tracker/features_per_camera"] = config.features_per_camera;
  values["tracker/fast_threshold"] = config.fast_threshold;
  values["ransac/max_epipolar_error_px"] = config.max_epipolar_error_px;
  values["solver"] = config.solver;
  values["publish_features"] = config.publish_features;
  values["publish_points"] = config.publish_points;
  return values;
}

/// Sets every number to the lowest or the highest that is allowed.
struct ToLimit {
  bool highest;

  template <class Number>
  void operator()(const char*, Number& value, double lowest_value, double highest_value) {
    value = static_cast<Number>(highest ? highest_value : lowest_value);
  }
  template <class Value>
  void operator()(const char*, Value&) {}
  void operator()(const char*, std::string&, std::initializer_list<const char*>) {}
};

EgoMotionConfig limit(Parameters parameters, bool highest) {
  ToLimit to_limit{highest};
  visitParameters(parameters, to_limit);
  return toConfig(parameters);
}

}  // namespace

LiveParameters::LiveParameters(const ros::NodeHandle& private_node, const Parameters& current, Apply apply)
    : private_node_(private_node), current_(current), apply_(std::move(apply)) {
  const ros::NodeHandle node(private_node_, kNamespace);
  const EgoMotionConfig config = toConfig(current_);
  config.__toServer__(node);
  server_ = std::make_unique<dynamic_reconfigure::Server<EgoMotionConfig>>(node);
  server_->setConfigDefault(config);
  server_->setConfigMin(limit(current_, false));
  server_->setConfigMax(limit(current_, true));
  server_->setCallback([this](EgoMotionConfig& changed, std::uint32_t level) {
    if (level != kAtStart) change(changed);
  });
}

LiveParameters::~LiveParameters() = default;

void LiveParameters::change(EgoMotionConfig& config) {
  Parameters wanted = current_;
  const ParameterMap values = toValues(config);
  std::string refusal;
  try {
    applyParameters(values, &wanted);
    refusal = apply_(wanted);
  } catch (const std::invalid_argument& error) {
    refusal = error.what();
  }
  if (!refusal.empty()) {
    ROS_ERROR("%s: change refused: %s", private_node_.getNamespace().c_str(), refusal.c_str());
    config = toConfig(current_);
    return;
  }
  current_ = std::move(wanted);
  for (const auto& [name, value] : values) private_node_.setParam(name, value);
}

}  // namespace multicam_egomotion
