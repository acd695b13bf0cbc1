// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <string>
#include <vector>

namespace multicam_egomotion {

/// A parameter of a fault: a number in [least, most], whole or not, or one of `choices`.
struct FaultParameter {
  std::string name;
  std::string default_value;
  std::string unit;
  double least = 0.0, most = 0.0;
  bool whole = false;
  std::vector<std::string> choices;
};

/// Checked values of a fault's parameters by name.
class FaultValues {
 public:
  /// Values as `name=value,name=value`, the others at their default. Throws std::invalid_argument with the fault, the
  /// parameter, what was found and what was expected.
  FaultValues(const std::string& fault, const std::vector<FaultParameter>& parameters, const std::string& text);

  double number(const std::string& name) const;
  int integer(const std::string& name) const { return static_cast<int>(number(name)); }
  const std::string& text(const std::string& name) const { return values_.at(name); }

 private:
  std::map<std::string, std::string> values_;
};

}  // namespace multicam_egomotion
