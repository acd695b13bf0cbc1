// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "multicam_egomotion/ros/parameters.h"

#include <ros/node_handle.h>
#include <yaml-cpp/yaml.h>

#include <cmath>
#include <initializer_list>
#include <sstream>
#include <stdexcept>

#include "parameter_list.h"

namespace multicam_egomotion {
namespace {

using XmlRpc::XmlRpcValue;

std::string shown(XmlRpcValue value) {
  std::ostringstream text;
  if (value.getType() == XmlRpcValue::TypeString) {
    text << '\'' << static_cast<std::string>(value) << '\'';
  } else if (value.getType() == XmlRpcValue::TypeBoolean) {
    text << (static_cast<bool>(value) ? "true" : "false");
  } else {
    text << value;
  }
  return text.str();
}

[[noreturn]] void refuse(const std::string& name, const XmlRpcValue& found, const std::string& expected) {
  throw std::invalid_argument("parameter '" + name + "': found " + shown(found) + ", expected " + expected);
}

/// Takes the values of the parameters out of a map; what remains is unknown.
class Reader {
 public:
  explicit Reader(ParameterMap values) : values_(std::move(values)) {}

  void operator()(const char* name, bool& value) {
    if (take(name)) {
      if (found_.getType() != XmlRpcValue::TypeBoolean) refuse(name, found_, "true or false");
      value = static_cast<bool>(found_);
    }
  }
  void operator()(const char* name, double& value, double lowest, double highest) {
    if (take(name)) value = number(name, lowest, highest, "a number");
  }
  template <class Integer>
  void operator()(const char* name, Integer& value, double lowest, double highest) {
    if (!take(name)) return;
    if (found_.getType() != XmlRpcValue::TypeInt) refuse(name, found_, range("an integer", lowest, highest));
    value = static_cast<Integer>(number(name, lowest, highest, "an integer"));
  }
  void operator()(const char* name, std::string& value) {
    if (!take(name)) return;
    if (found_.getType() != XmlRpcValue::TypeString) refuse(name, found_, "a text");
    value = static_cast<std::string>(found_);
  }
  void operator()(const char* name, std::string& value, std::initializer_list<const char*> choices) {
    const std::string before = value;
    (*this)(name, value);
    std::string expected;
    for (const char* choice : choices) {
      if (value == choice) return;
      expected += (expected.empty() ? "" : ", ") + std::string(choice);
    }
    value = before;
    refuse(name, found_, "one of " + expected);
  }
  void operator()(const char* name, std::vector<std::string>& value) {
    if (!take(name)) return;
    if (found_.getType() != XmlRpcValue::TypeArray) refuse(name, found_, "a list of texts");
    value.clear();
    for (int i = 0; i < found_.size(); ++i) {
      if (found_[i].getType() != XmlRpcValue::TypeString) refuse(name, found_, "a list of texts");
      value.push_back(static_cast<std::string>(found_[i]));
    }
  }

  std::vector<std::string> unknown() const {
    std::vector<std::string> names;
    for (const auto& [name, value] : values_) names.push_back(name);
    return names;
  }

 private:
  bool take(const char* name) {
    const auto entry = values_.find(name);
    if (entry == values_.end()) return false;
    found_ = entry->second;
    values_.erase(entry);
    return true;
  }
  static std::string range(const char* what, double lowest, double highest) {
    std::ostringstream text;
    text << what << " in [" << lowest << ", " << highest << "]";
    return text.str();
  }
  double number(const char* name, double lowest, double highest, const char* what) {
    double value = NAN;
    if (found_.getType() == XmlRpcValue::TypeInt) value = static_cast<int>(found_);
    if (found_.getType() == XmlRpcValue::TypeDouble) value = static_cast<double>(found_);
    if (!(value >= lowest && value <= highest)) {
      const bool text = found_.getType() == XmlRpcValue::TypeString;
      refuse(name, found_,
             range(what, lowest, highest) + (text ? " (YAML 1.1 reads 1e-3 as a text: write 1.0e-3)" : ""));
    }
    return value;
  }

  ParameterMap values_;
  XmlRpcValue found_;
};

class Writer {
 public:
  void operator()(const char* name, bool& value) { values[name] = XmlRpcValue(value); }
  void operator()(const char* name, double& value, double, double) { values[name] = XmlRpcValue(value); }
  template <class Integer>
  void operator()(const char* name, Integer& value, double, double) {
    values[name] = XmlRpcValue(static_cast<int>(value));
  }
  void operator()(const char* name, std::string& value) { values[name] = XmlRpcValue(value); }
  void operator()(const char* name, std::string& value, std::initializer_list<const char*>) { (*this)(name, value); }
  void operator()(const char* name, std::vector<std::string>& value) {
    XmlRpcValue list;
    list.setSize(static_cast<int>(value.size()));
    for (std::size_t i = 0; i < value.size(); ++i) list[static_cast<int>(i)] = value[i];
    values[name] = list;
  }

  ParameterMap values;
};

void flatten(const std::string& prefix, XmlRpcValue value, ParameterMap* result) {
  if (value.getType() == XmlRpcValue::TypeStruct) {
    for (auto& [name, child] : value) flatten(prefix.empty() ? name : prefix + "/" + name, child, result);
  } else {
    (*result)[prefix] = value;
  }
}

/// A plain YAML scalar as roslaunch would type it; a quoted one is a text.
XmlRpcValue scalar(const YAML::Node& node) {
  const bool quoted = node.Tag() == "!";
  bool flag;
  int integer;
  double number;
  if (!quoted && YAML::convert<bool>::decode(node, flag)) return XmlRpcValue(flag);
  if (!quoted && YAML::convert<int>::decode(node, integer)) return XmlRpcValue(integer);
  if (!quoted && YAML::convert<double>::decode(node, number)) return XmlRpcValue(number);
  return XmlRpcValue(node.Scalar());
}

/// Aliases can make a short file deep or long without end.
constexpr int kMaxDepth = 10;
constexpr std::size_t kMaxValues = 1000;

void flatten(const std::string& prefix, const YAML::Node& node, int depth, ParameterMap* result) {
  if (depth > kMaxDepth || result->size() > kMaxValues) {
    throw std::invalid_argument("'" + prefix.substr(0, 100) + "': found more than " + std::to_string(kMaxDepth) +
                                " levels or " + std::to_string(kMaxValues) + " values, expected parameters");
  }
  if (node.IsMap()) {
    for (const auto& child : node) {
      const std::string name = child.first.as<std::string>();
      flatten(prefix.empty() ? name : prefix + "/" + name, child.second, depth + 1, result);
    }
  } else if (node.IsSequence()) {
    XmlRpcValue list;
    list.setSize(static_cast<int>(node.size()));
    for (std::size_t i = 0; i < node.size(); ++i) list[static_cast<int>(i)] = scalar(node[i]);
    (*result)[prefix] = list;
  } else if (node.IsScalar()) {
    (*result)[prefix] = scalar(node);
  }
}

}  // namespace

ParameterMap readParameterServer(const ros::NodeHandle& private_node) {
  ParameterMap result;
  XmlRpcValue tree;
  if (private_node.getParam(private_node.getNamespace(), tree)) flatten("", tree, &result);
  return result;
}

ParameterMap readParameterFile(const std::string& path) {
  ParameterMap result;
  try {
    const YAML::Node root = YAML::LoadFile(path);
    if (!root.IsMap() && !root.IsNull()) throw std::invalid_argument(path + ": found no names, expected `name: value`");
    flatten("", root, 0, &result);
  } catch (const YAML::BadFile&) {
    throw std::invalid_argument(path + ": cannot be read, expected a YAML file of parameters");
  } catch (const YAML::Exception& error) {
    throw std::invalid_argument(path + ": " + error.what());
  }
  return result;
}

std::vector<std::string> applyParameters(const ParameterMap& values, Parameters* parameters) {
  Reader reader(values);
  visitParameters(*parameters, reader);
  return reader.unknown();
}

ParameterMap parameterValues(const Parameters& parameters) {
  Parameters copy = parameters;
  Writer writer;
  visitParameters(copy, writer);
  return writer.values;
}

}  // namespace multicam_egomotion
