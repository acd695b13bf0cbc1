// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "fault_injection/fault.h"

namespace multicam_egomotion {

// Faults of the IMU.

Fault imuLost(const FaultSetting& setting);         ///< no samples
Fault imuFrozen(const FaultSetting& setting);       ///< the first values again and again, with new stamps
Fault imuNan(const FaultSetting& setting);          ///< every n-th sample is not a number
Fault imuSaturated(const FaultSetting& setting);    ///< values cut at the end of the range
Fault imuInG(const FaultSetting& setting);          ///< accelerations in g, not in m/s^2
Fault imuSwappedAxes(const FaultSetting& setting);  ///< two axes changed for one another
Fault imuRate(const FaultSetting& setting);         ///< fewer samples
Fault imuBias(const FaultSetting& setting);         ///< values off by a constant
Fault imuOrientation(const FaultSetting& setting);  ///< identity orientation with zero covariance, as unset

}  // namespace multicam_egomotion
