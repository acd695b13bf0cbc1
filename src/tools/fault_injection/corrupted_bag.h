// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "fault_injection/fault_registry.h"

namespace multicam_egomotion {

/// Writes the bag `input` with the faults, one after the other, to `output`. The same faults and seed give the same
/// messages. Throws std::invalid_argument when a fault names a camera that the bag does not have, or both bags are the
/// same file; rosbag::BagException when a bag cannot be read or written.
void corruptBag(const std::string& input, const std::string& output, const std::vector<FaultRequest>& faults,
                std::uint64_t seed);

}  // namespace multicam_egomotion
