// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "paper_experiments/csv_file.h"

#include <cmath>
#include <stdexcept>

namespace multicam_egomotion {

CsvFile::CsvFile(const std::string& path, const std::string& header)
    : path_(path), file_(std::fopen(path.c_str(), "w")) {
  if (file_ == nullptr) throw std::runtime_error("cannot write " + path);
  write(header);
}

CsvFile::~CsvFile() { std::fclose(file_); }

std::string CsvFile::text(double value) {
  if (!std::isfinite(value)) return "no data";
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, "%.6g", value);
  return buffer;
}

void CsvFile::write(const std::string& line) {
  if (std::fputs(line.c_str(), file_) < 0 || std::fputc('\n', file_) < 0) {
    throw std::runtime_error("cannot write " + path_);
  }
}

}  // namespace multicam_egomotion
