// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/node_handle.h>
#include <rosbag/bag.h>

#include <memory>
#include <string>

#include "multicam_egomotion/odometry/ego_motion_result.h"
#include "multicam_egomotion/ros/messages.h"

namespace multicam_egomotion {

// The message multicam_egomotion/EgoMotion has the name of the class EgoMotion, so no source file includes both: it is
// declared here by the name of its template, and handled through these functions.
template <class Allocator>
struct EgoMotion_;
using EgoMotionMessage = EgoMotion_<std::allocator<void>>;

/// The motion since the previous frame set with what is known of its quality (contract 10).
EgoMotionMessage toEgoMotionMessage(const EgoMotionResult& result, const FrameNames& frames);

void writeEgoMotion(rosbag::Bag* bag, const std::string& topic, const ros::Time& time, const EgoMotionResult& result,
                    const FrameNames& frames);
ros::Publisher advertiseEgoMotion(ros::NodeHandle& node, const std::string& topic, std::uint32_t queue_size);
void publishEgoMotion(const ros::Publisher& publisher, const EgoMotionResult& result, const FrameNames& frames);

}  // namespace multicam_egomotion
