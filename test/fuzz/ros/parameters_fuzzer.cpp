// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
// Any text as a parameter file: refused with a message, or options with which the odometry starts or refuses them.
#include <stdexcept>

#include "../expect.h"
#include "../memory_file.h"
#include "multicam_egomotion/odometry/ego_motion.h"
#include "multicam_egomotion/ros/parameters.h"

namespace multicam_egomotion {
namespace {

CameraRig smallRig() {
  const CameraModel model(64, 48, 50.0, 50.0, 31.5, 23.5, Distortion::kNone, {});
  return CameraRig({{"cam0", "cam0", model, Eigen::Isometry3d::Identity(), 0.0}});
}

void useText(const std::string& text) {
  static const CameraRig rig = smallRig();
  const MemoryFile file(text);
  try {
    Parameters parameters;
    const std::vector<std::string> unknown = applyParameters(readParameterFile(file.path()), &parameters);
    const ParameterMap values = parameterValues(parameters);
    Parameters again;
    expect(applyParameters(values, &again).empty(), "no unknown name among the own ones");
    expect(parameterValues(again) == values, "the same values once written and read again");
    EgoMotion(rig, parameters.imu, parameters.odometry);
  } catch (const std::invalid_argument& error) {
    expect(error.what()[0] != '\0', "a message");
  }
}

}  // namespace
}  // namespace multicam_egomotion

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  multicam_egomotion::useText(std::string(data, data + size));
  return 0;
}
