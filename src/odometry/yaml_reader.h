// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <yaml-cpp/yaml.h>

#include <Eigen/Geometry>
#include <string>
#include <vector>

namespace multicam_egomotion {

/// A place in a YAML file that knows its own name: every failure is a std::runtime_error with file, key, found,
/// expected.
class YamlReader {
 public:
  /// Root of a file, which must be a map.
  explicit YamlReader(const std::string& file);

  bool has(const std::string& key) const;
  YamlReader at(const std::string& key) const;  ///< a key that must be there
  YamlReader at(std::size_t index) const;       ///< an element of a list
  std::size_t size() const { return node_.size(); }
  bool isList() const { return node_.IsSequence(); }

  std::string text() const;
  double number() const;
  double positiveNumber() const;
  std::vector<double> numbers() const;               ///< a list of any length
  std::vector<double> numbers(std::size_t n) const;  ///< a list of n
  std::vector<int> integers(std::size_t n) const;
  Eigen::Isometry3d transform() const;  ///< 4 rows of 4, or 16 numbers row by row

  std::string text(const std::string& key, const std::string& fallback) const;
  double number(const std::string& key, double fallback) const;
  double positiveNumber(const std::string& key, double fallback) const;
  /// A number from 0 to `most`.
  double numberUpTo(double most, const std::string& key, double fallback) const;

  /// Refuses a key that is none of these: a misspelt option must not be ignored.
  void allowOnly(const std::vector<std::string>& keys) const;

  [[noreturn]] void fail(const std::string& found, const std::string& expected) const;
  /// The message of an exception, with file and key in front.
  [[noreturn]] void fail(const std::exception& error) const;

 private:
  YamlReader(std::string file, std::string key, const YAML::Node& node);
  void expectList(std::size_t n) const;

  std::string file_, key_;
  YAML::Node node_;
};

}  // namespace multicam_egomotion
