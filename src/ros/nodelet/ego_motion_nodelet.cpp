// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include <nodelet/nodelet.h>

#include <pluginlib/class_list_macros.hpp>

#include "multicam_egomotion/ros/ego_motion_ros.h"

namespace multicam_egomotion {

/// The odometry as a nodelet; the manager refuses it when its parameters are wrong.
class EgoMotionNodelet : public nodelet::Nodelet {
  void onInit() override {
    try {
      odometry_ = std::make_unique<EgoMotionRos>(getNodeHandle(), getPrivateNodeHandle());
    } catch (const std::exception& error) {
      NODELET_FATAL("%s", error.what());
      throw;
    }
  }

  std::unique_ptr<EgoMotionRos> odometry_;
};

}  // namespace multicam_egomotion

PLUGINLIB_EXPORT_CLASS(multicam_egomotion::EgoMotionNodelet, nodelet::Nodelet)
