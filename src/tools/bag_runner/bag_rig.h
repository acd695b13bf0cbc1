// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <rosbag/bag.h>

#include "multicam_egomotion/ros/rig_setup.h"

namespace multicam_egomotion {

/// Replaces each topic by the one that the bag has: as named, from the root, or compressed. Throws
/// std::invalid_argument that lists the bag's topics when an input is not there; camera_infos are looked up only where
/// `need_infos`.
void matchTopics(const rosbag::Bag& bag, bool use_imu, bool need_infos, RigTopics* topics);

/// Number of cameras cam0, cam1, ... whose images are in the bag.
int camerasInBag(const rosbag::Bag& bag);

/// Rig of the bag's own CameraInfo and TF. Throws std::invalid_argument naming what is missing.
RigSetup rigFromBag(const rosbag::Bag& bag, const Parameters& parameters, const RigTopics& topics);

}  // namespace multicam_egomotion
