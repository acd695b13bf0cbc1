// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "fault_injection/fault.h"

namespace multicam_egomotion {
namespace {

bool chosenCamera(const FaultSetting& setting, const RecordedMessage& message) {
  const std::optional<int> camera = cameraOf(message, setting.layout);
  const int chosen = setting.values.integer("camera");
  return camera && (chosen < 0 || *camera == chosen);
}

}  // namespace

double FaultSetting::since(const RecordedMessage& message, const char* parameter) const {
  return (message.recorded - layout.begin).toSec() - values.number(parameter);
}

bool FaultSetting::active(const RecordedMessage& message) const {
  return since(message, "from") >= 0.0 && since(message, "to") < 0.0;
}

bool FaultSetting::activeImage(const RecordedMessage& message) const {
  return isImage(message) && active(message) && chosenCamera(*this, message);
}

bool FaultSetting::activeCameraInfo(const RecordedMessage& message) const {
  return isCameraInfo(message) && active(message) && chosenCamera(*this, message);
}

}  // namespace multicam_egomotion
