// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "fault_injection/fault_values.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <sstream>
#include <stdexcept>

namespace multicam_egomotion {
namespace {

std::string joined(const std::vector<std::string>& texts) {
  std::string all;
  for (const std::string& text : texts) all += (all.empty() ? "" : ", ") + text;
  return all.empty() ? "none" : all;
}

bool toNumber(const std::string& text, double* value) {
  char* end = nullptr;
  *value = std::strtod(text.c_str(), &end);
  return !text.empty() && *end == '\0' && !std::isnan(*value);
}

void check(const std::string& fault, const FaultParameter& parameter, const std::string& found) {
  std::ostringstream expected;
  if (!parameter.choices.empty()) {
    if (std::count(parameter.choices.begin(), parameter.choices.end(), found) > 0) return;
    expected << "one of " << joined(parameter.choices);
  } else {
    double value = 0.0;
    const bool good = toNumber(found, &value) && value >= parameter.least && value <= parameter.most &&
                      (!parameter.whole || value == std::floor(value));
    if (good) return;
    expected << (parameter.whole ? "a whole number" : "a number") << " from " << parameter.least << " to "
             << parameter.most << (parameter.unit.empty() ? "" : " [" + parameter.unit + "]");
  }
  throw std::invalid_argument("fault " + fault + ": " + parameter.name + " is '" + found + "', expected " +
                              expected.str());
}

}  // namespace

FaultValues::FaultValues(const std::string& fault, const std::vector<FaultParameter>& parameters,
                         const std::string& text) {
  std::vector<std::string> names;
  for (const FaultParameter& parameter : parameters) {
    names.push_back(parameter.name);
    values_[parameter.name] = parameter.default_value;
  }
  std::istringstream settings(text);
  for (std::string setting; std::getline(settings, setting, ',');) {
    const std::size_t equals = setting.find('=');
    if (equals == std::string::npos) {
      throw std::invalid_argument("fault " + fault + ": found '" + setting + "', expected name=value");
    }
    const std::string name = setting.substr(0, equals);
    const auto parameter =
        std::find_if(parameters.begin(), parameters.end(), [&](const FaultParameter& one) { return one.name == name; });
    if (parameter == parameters.end()) {
      throw std::invalid_argument("fault " + fault + ": found parameter '" + name + "', expected one of " +
                                  joined(names));
    }
    check(fault, *parameter, setting.substr(equals + 1));
    values_[name] = setting.substr(equals + 1);
  }
  if (values_.count("from") > 0 && values_.count("to") > 0 && number("from") >= number("to")) {
    throw std::invalid_argument("fault " + fault + ": from is " + values_["from"] +
                                ", expected less than to, which is " + values_["to"]);
  }
}

double FaultValues::number(const std::string& name) const { return std::strtod(values_.at(name).c_str(), nullptr); }

}  // namespace multicam_egomotion
