// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "multicam_egomotion/odometry/rig_file.h"
#include "yaml_reader.h"

namespace multicam_egomotion {

/// Rig of a Kalibr camchain-imucam.yaml (root given) and its imu.yaml (empty: default noise densities).
RigFile readKalibrRig(const YamlReader& root, const std::string& imu_path);

}  // namespace multicam_egomotion
