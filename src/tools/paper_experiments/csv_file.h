// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdio>
#include <string>

namespace multicam_egomotion {

/// A table of comma-separated values with a header row. Values that are not finite are written as "no data".
class CsvFile {
 public:
  /// Throws std::runtime_error when the file cannot be written.
  CsvFile(const std::string& path, const std::string& header);
  ~CsvFile();
  CsvFile(const CsvFile&) = delete;
  CsvFile& operator=(const CsvFile&) = delete;

  template <class... Values>
  void row(const Values&... values) {
    std::string line;
    ((line += (line.empty() ? "" : ",") + text(values)), ...);
    write(line);
  }

 private:
  static std::string text(double value);
  static std::string text(int value) { return std::to_string(value); }
  static std::string text(std::size_t value) { return std::to_string(value); }
  static std::string text(const std::string& value) { return value; }
  void write(const std::string& line);

  std::string path_;
  std::FILE* file_;
};

}  // namespace multicam_egomotion
