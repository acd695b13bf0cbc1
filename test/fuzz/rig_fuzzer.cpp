// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
// Any text as a rig file: refused with a message, or a rig that works and is the same once written and read again.
#include <algorithm>
#include <stdexcept>

#include "expect.h"
#include "memory_file.h"
#include "multicam_egomotion/odometry/rig_file.h"

namespace multicam_egomotion {
namespace {

void useCamera(const CameraModel& model) {
  for (const double share : {0.0, 0.31, 0.5, 1.0}) {
    const Eigen::Vector2d pixel(share * (model.width() - 1), (1.0 - share) * (model.height() - 1));
    Eigen::Vector3d bearing;
    Eigen::Vector2d again;
    if (!model.unproject(pixel, &bearing)) continue;
    expect(bearing.allFinite(), "finite bearings");
    if (model.project(bearing, &again)) expect(again.allFinite(), "finite pixels");
  }
}

/// What is no UTF-8 is written as replacement characters.
bool sameText(const std::string& original, const std::string& copy) {
  const bool ascii = std::all_of(original.begin(), original.end(), [](char c) { return c > 0; });
  return !ascii || original == copy;
}

void useText(const std::string& text) {
  const MemoryFile file(text);
  try {
    const RigFile rig = loadRigFile(file.path());
    for (const RigCamera& camera : rig.rig.cameras()) useCamera(camera.model);
    const MemoryFile copy;
    writeRigFile(copy.path(), rig);
    const RigFile again = loadRigFile(copy.path());
    expect(again.rig.size() == rig.rig.size(), "as many cameras in the copy");
    for (int i = 0; i < rig.rig.size(); ++i) {
      const RigCamera &one = rig.rig.camera(i), &other = again.rig.camera(i);
      expect(sameText(one.name, other.name) && sameText(one.frame_id, other.frame_id) &&
                 sameText(rig.image_topics[i], again.image_topics[i]) && one.time_offset_s == other.time_offset_s,
             "the same camera in the copy");
      expect(one.model.fx() == other.model.fx() && one.model.coefficients() == other.model.coefficients(),
             "the same camera model in the copy");
    }
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
