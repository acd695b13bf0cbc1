// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "fault_injection/fault.h"

namespace multicam_egomotion {

// Faults of stamps and of the order of arrival. Stamps are those of images, CameraInfo and IMU samples.

Fault timeJump(const FaultSetting& setting);          ///< all stamps from `at` on are off by `by`
Fault timeGap(const FaultSetting& setting);           ///< no images and no IMU
Fault bagLoop(const FaultSetting& setting);           ///< the recording again, with its original stamps
Fault duplicateImages(const FaultSetting& setting);   ///< every n-th image arrives twice
Fault duplicateImu(const FaultSetting& setting);      ///< every n-th sample arrives twice
Fault outOfOrderImages(const FaultSetting& setting);  ///< every n-th image arrives late
Fault outOfOrderImu(const FaultSetting& setting);     ///< every n-th sample arrives late
Fault lateImages(const FaultSetting& setting);        ///< all images of a camera arrive late
Fault lateImu(const FaultSetting& setting);           ///< all samples arrive late
Fault clockOffset(const FaultSetting& setting);       ///< the cameras' clock is off by `offset`
Fault zeroStamps(const FaultSetting& setting);        ///< every n-th stamp is 0

}  // namespace multicam_egomotion
