// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "multicam_egomotion/odometry/ego_motion.h"
#include "multicam_egomotion/odometry/rig_file.h"
#include "multicam_egomotion/ros/node_options.h"

namespace multicam_egomotion {

/// The rig file of a run with the calibration that the run has estimated.
class RigOutput {
 public:
  /// `file`: the rig as the run knows it. Throws std::invalid_argument when `path` is a file that this run reads,
  /// std::runtime_error when it cannot be written.
  RigOutput(const std::string& path, const RigFile& file, const NodeOptions& inputs);

  /// Throws std::runtime_error when the file cannot be written.
  void write(const EgoMotion& odometry) const;

 private:
  std::string path_;
  RigFile file_;
};

}  // namespace multicam_egomotion
