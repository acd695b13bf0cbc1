// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "bag_runner/rig_output.h"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <system_error>

#include "multicam_egomotion/odometry/calibrated_rig.h"

namespace multicam_egomotion {

RigOutput::RigOutput(const std::string& path, const RigFile& file, const NodeOptions& inputs)
    : path_(path), file_(file) {
  for (const std::string& input : {inputs.rig_file, inputs.rig_imu_file}) {
    std::error_code missing;
    if (!input.empty() && std::filesystem::equivalent(path, input, missing)) {
      throw std::invalid_argument("--write-rig: found '" + path + "', which this run reads, expected another file");
    }
  }
  // Before the run, which may be long; an older file stays until there is a newer one.
  if (!std::ofstream(path, std::ios::app)) {
    throw std::runtime_error("'" + path + "' cannot be written: " + std::strerror(errno));
  }
}

void RigOutput::write(const EgoMotion& odometry) const {
  RigFile calibrated = file_;
  calibrated.rig = calibratedRig(file_.rig, odometry.calibration());
  writeRigFile(path_, calibrated);
}

}  // namespace multicam_egomotion
