// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "fault_injection/fault.h"

namespace multicam_egomotion {

// Faults of what a camera's driver says of its images.

Fault cameraLost(const FaultSetting& setting);          ///< no images and no CameraInfo of a camera
Fault imageEncoding(const FaultSetting& setting);       ///< raw images in another encoding
Fault imageTruncated(const FaultSetting& setting);      ///< the end of the data is missing
Fault cameraInfoAbsent(const FaultSetting& setting);    ///< no CameraInfo
Fault cameraInfoZero(const FaultSetting& setting);      ///< as of a camera that was never calibrated
Fault cameraInfoMismatch(const FaultSetting& setting);  ///< CameraInfo of another image size
Fault sharedFrameId(const FaultSetting& setting);       ///< one frame_id for all cameras

}  // namespace multicam_egomotion
