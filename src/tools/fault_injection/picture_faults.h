// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "fault_injection/fault.h"

namespace multicam_egomotion {

// Faults of the picture itself, in raw (8 and 16 bits) and compressed images; grey levels are those of 8 bits.

Fault imageSize(const FaultSetting& setting);      ///< resized by `scale`
Fault imageBlank(const FaultSetting& setting);     ///< one grey level all over
Fault imageGain(const FaultSetting& setting);      ///< brightness times `factor`, cut at white
Fault imageNoise(const FaultSetting& setting);     ///< white noise
Fault imageFrozen(const FaultSetting& setting);    ///< the first picture again and again, with new stamps
Fault exposureSteps(const FaultSetting& setting);  ///< brightness times `factor` in every other period
Fault obstruction(const FaultSetting& setting);    ///< a grey rectangle in front of the camera
Fault movingObject(const FaultSetting& setting);   ///< a textured rectangle that crosses the image

}  // namespace multicam_egomotion
