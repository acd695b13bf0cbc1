// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <fstream>
#include <stdexcept>
#include <string>

namespace multicam_egomotion {

/// A table of comma-separated values with a header row. Values that are not finite are written as "no data".
class CsvFile {
 public:
  /// Throws std::runtime_error when the file cannot be written; so does row().
  CsvFile(const std::string& path, const std::string& header) : path_(path), file_(path) { row(header); }

  template <class First, class... Others>
  void row(const First& first, const Others&... others) {
    write(first);
    ((file_ << ',', write(others)), ...);
    file_ << std::endl;
    if (!file_) throw std::runtime_error(path_ + ": cannot be written");
  }

 private:
  template <class Value>
  void write(const Value& value) {
    file_ << value;
  }
  void write(double value) { std::isfinite(value) ? file_ << value : file_ << "no data"; }

  std::string path_;
  std::ofstream file_;
};

}  // namespace multicam_egomotion
