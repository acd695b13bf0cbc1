// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
// The odometry as a plain node; exit code 0 after SIGINT or SIGTERM, 1 when its configuration is wrong.
#include <ros/callback_queue.h>
#include <ros/ros.h>

#include <cstdio>

#include "multicam_egomotion/ros/ego_motion_ros.h"
#include "stop_signals.h"

int main(int argc, char** argv) {
  using multicam_egomotion::StopSignals;
  StopSignals::watch(&ros::requestShutdown);
  ros::init(argc, argv, "egomotion", ros::init_options::NoSigintHandler);
  try {
    multicam_egomotion::EgoMotionRos odometry(ros::NodeHandle(), ros::NodeHandle("~"));
    while (ros::ok() && !StopSignals::received() && !odometry.configurationFailed()) {
      ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(0.02));
    }
    return odometry.configurationFailed() ? 1 : 0;
  } catch (const std::exception& error) {
    if (StopSignals::received()) return 0;
    // The end of the last node handle has ended ROS's own log.
    std::fprintf(stderr, "egomotion_node: %s\n", error.what());
    return 1;
  }
}
