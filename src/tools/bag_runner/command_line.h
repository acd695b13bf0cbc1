// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace multicam_egomotion {

/// What egomotion_bag was asked to do; empty paths were not given.
struct BagCommand {
  std::string rig, rig_imu, config, bag, imu_topic, trajectory, kitti, report, output_bag, write_rig;
};

/// False when only help was wanted, which has been printed. Throws std::invalid_argument.
bool parseCommandLine(int argc, char** argv, BagCommand* command);

}  // namespace multicam_egomotion
