// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/node_handle.h>

#include <functional>
#include <memory>
#include <string>

#include "multicam_egomotion/ros/parameters.h"

namespace dynamic_reconfigure {
template <class Config>
class Server;
}

namespace multicam_egomotion {

class EgoMotionConfig;

/// The parameters that may change while running, offered by dynamic_reconfigure at `~tuning`. They start with the
/// values of the parameters; a change is checked as those are, refused as a whole, or written back to them, so that a
/// node that starts again goes on with it.
class LiveParameters {
 public:
  /// Name space of dynamic_reconfigure's own copies below the private one.
  static constexpr const char* kNamespace = "tuning";

  /// Puts values into effect that are right by themselves; answers why it refuses, empty on success. Called on the
  /// threads of the handle's callback queue, one at a time.
  using Apply = std::function<std::string(const Parameters& wanted)>;

  LiveParameters(const ros::NodeHandle& private_node, const Parameters& current, Apply apply);
  ~LiveParameters();

 private:
  void change(EgoMotionConfig& config);

  const ros::NodeHandle private_node_;
  Parameters current_;
  const Apply apply_;
  std::unique_ptr<dynamic_reconfigure::Server<EgoMotionConfig>> server_;
};

}  // namespace multicam_egomotion
