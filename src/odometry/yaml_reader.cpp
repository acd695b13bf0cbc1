// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "yaml_reader.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "multicam_egomotion/geometry/rigid_transform.h"

namespace multicam_egomotion {
namespace {

YAML::Node parse(const std::string& file) {
  std::ifstream stream(file);
  std::ostringstream content;
  if (!stream || !(content << stream.rdbuf())) {
    throw std::runtime_error(file + ": cannot be read or is empty, expected a YAML file");
  }
  YAML::Node root;
  try {
    root = YAML::Load(content.str());
  } catch (const YAML::Exception& error) {
    throw std::runtime_error(file + ": is not YAML: " + error.what());
  }
  if (!root.IsMap()) throw std::runtime_error(file + ": found no keys, expected a YAML map");
  return root;
}

// What stands in the file, for a message.
std::string describe(const YAML::Node& node) {
  if (node.IsNull()) return "nothing";
  if (node.IsScalar()) return "'" + node.Scalar() + "'";
  if (node.IsSequence()) return "a list of " + std::to_string(node.size());
  return "a map";
}

}  // namespace

YamlReader::YamlReader(const std::string& file) : file_(file), node_(parse(file)) {}

YamlReader::YamlReader(std::string file, std::string key, const YAML::Node& node)
    : file_(std::move(file)), key_(std::move(key)), node_(node) {}

void YamlReader::fail(const std::string& found, const std::string& expected) const {
  throw std::runtime_error(file_ + ": " + (key_.empty() ? "" : key_ + ": ") + "found " + found + ", expected " +
                           expected);
}

void YamlReader::fail(const std::exception& error) const {
  throw std::runtime_error(file_ + ": " + (key_.empty() ? "" : key_ + ": ") + error.what());
}

bool YamlReader::has(const std::string& key) const { return node_.IsMap() && node_[key]; }

YamlReader YamlReader::at(const std::string& key) const {
  if (!node_.IsMap()) fail(describe(node_), "a map with the key " + key);
  const YamlReader child(file_, key_.empty() ? key : key_ + "." + key, node_[key]);
  if (!child.node_) YamlReader(file_, child.key_, YAML::Node()).fail("no such key", "it to be given");
  return child;
}

YamlReader YamlReader::at(std::size_t index) const {
  return YamlReader(file_, key_ + "[" + std::to_string(index) + "]", node_[index]);
}

std::string YamlReader::text() const {
  if (!node_.IsScalar()) fail(describe(node_), "a text");
  return node_.Scalar();
}

double YamlReader::number() const {
  double value;
  if (!node_.IsScalar() || !YAML::convert<double>::decode(node_, value) || !std::isfinite(value)) {
    fail(describe(node_), "a finite number");
  }
  return value;
}

double YamlReader::positiveNumber() const {
  const double value = number();
  if (!(value > 0)) fail(describe(node_), "a positive number");
  return value;
}

void YamlReader::expectList(std::size_t n) const {
  if (!isList() || size() != n) fail(describe(node_), "a list of " + std::to_string(n));
}

std::vector<double> YamlReader::numbers() const {
  if (!isList()) fail(describe(node_), "a list of numbers");
  std::vector<double> values;
  for (std::size_t i = 0; i < size(); ++i) values.push_back(at(i).number());
  return values;
}

std::vector<double> YamlReader::numbers(std::size_t n) const {
  expectList(n);
  return numbers();
}

std::vector<int> YamlReader::integers(std::size_t n) const {
  std::vector<int> values;
  for (const double value : numbers(n)) {
    if (value != std::floor(value) || std::abs(value) > 1e9) fail(std::to_string(value), "whole numbers");
    values.push_back(static_cast<int>(value));
  }
  return values;
}

Eigen::Isometry3d YamlReader::transform() const {
  const bool flat = isList() && size() == 16;
  if (!flat && !(isList() && size() == 4)) fail(describe(node_), "4 rows of 4 numbers, or 16 numbers row by row");
  Eigen::Matrix4d matrix;
  for (int row = 0; row < 4; ++row) {
    const std::vector<double> values = flat ? std::vector<double>() : at(row).numbers(4);
    for (int column = 0; column < 4; ++column) {
      matrix(row, column) = flat ? at(4 * row + column).number() : values[column];
    }
  }
  try {
    return rigidTransform(matrix);
  } catch (const std::invalid_argument& error) {
    fail(error);
  }
}

std::string YamlReader::text(const std::string& key, const std::string& fallback) const {
  return has(key) ? at(key).text() : fallback;
}

double YamlReader::number(const std::string& key, double fallback) const {
  return has(key) ? at(key).number() : fallback;
}

double YamlReader::positiveNumber(const std::string& key, double fallback) const {
  return has(key) ? at(key).positiveNumber() : fallback;
}

double YamlReader::numberUpTo(double most, const std::string& key, double fallback) const {
  if (!has(key)) return fallback;
  const double value = at(key).number();
  if (value < 0 || value > most) {
    std::ostringstream expected;
    expected << "a number from 0 to " << most;
    at(key).fail(describe(at(key).node_), expected.str());
  }
  return value;
}

void YamlReader::allowOnly(const std::vector<std::string>& keys) const {
  if (!node_.IsMap()) fail(describe(node_), "a map");
  for (const auto& entry : node_) {
    const std::string key = entry.first.IsScalar() ? entry.first.Scalar() : describe(entry.first);
    if (std::find(keys.begin(), keys.end(), key) != keys.end()) continue;
    std::string expected = "one of";
    for (const std::string& known : keys) expected += " " + known;
    fail("the unknown key '" + key + "'", expected);
  }
}

}  // namespace multicam_egomotion
