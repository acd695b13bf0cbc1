// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
// The odometry as a plain node; exit code 1 when its configuration is wrong.
#include <ros/callback_queue.h>
#include <ros/ros.h>

#include <cstdio>

#include "multicam_egomotion/ros/ego_motion_ros.h"

int main(int argc, char** argv) {
  ros::init(argc, argv, "egomotion");
  try {
    multicam_egomotion::EgoMotionRos odometry(ros::NodeHandle(), ros::NodeHandle("~"));
    while (ros::ok() && !odometry.configurationFailed()) {
      ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(0.1));
    }
    return odometry.configurationFailed() ? 1 : 0;
  } catch (const std::exception& error) {
    // The end of the last node handle has ended ROS's own log.
    std::fprintf(stderr, "egomotion_node: %s\n", error.what());
    return 1;
  }
}
