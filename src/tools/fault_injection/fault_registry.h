// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "fault_injection/fault.h"

namespace multicam_egomotion {

/// A kind of fault: what it is called, what it does, what can be set, and how it is made.
struct FaultKind {
  std::string name;
  std::string summary;
  std::vector<FaultParameter> parameters;
  Fault (*make)(const FaultSetting& setting);
};

/// All kinds, in the order in which they are listed.
const std::vector<FaultKind>& faultKinds();

/// One line a kind: name, parameters with default and unit, summary.
std::string faultList();

/// A fault as written on the command line: `name` or `name:parameter=value,parameter=value`.
struct FaultRequest {
  const FaultKind* kind;
  FaultValues values;
};

/// Throws std::invalid_argument on a name or a value that is wrong, with what was expected.
FaultRequest parseFault(const std::string& text);

}  // namespace multicam_egomotion
