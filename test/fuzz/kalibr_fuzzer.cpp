// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
// Any text as Kalibr's camchain-imucam.yaml, and what follows a line "# imu" as its imu.yaml: refused with a message,
// or a rig.
#include <stdexcept>

#include "expect.h"
#include "memory_file.h"
#include "multicam_egomotion/odometry/rig_file.h"

namespace multicam_egomotion {
namespace {

void useText(const std::string& text) {
  const std::string separator = "\n# imu\n";
  const std::size_t at = text.find(separator);
  const MemoryFile cameras(text.substr(0, at));
  const MemoryFile imu(at == std::string::npos ? "" : text.substr(at + separator.size()));
  try {
    const RigFile rig = loadRigFile(cameras.path(), at == std::string::npos ? "" : imu.path());
    expect(rig.rig.baseline() >= 0.0 && rig.rig.baseline() < 1000.0, "a baseline");
    expect(!rig.has_imu || rig.imu.T_body_imu.matrix().allFinite(), "a finite mounting of the IMU");
  } catch (const std::runtime_error& error) {
    expect(error.what()[0] != '\0', "a message");
  }
}

}  // namespace
}  // namespace multicam_egomotion

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  multicam_egomotion::useText(std::string(data, data + size));
  return 0;
}
