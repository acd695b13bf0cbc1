// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <unistd.h>

#include <cstdio>
#include <string>

namespace multicam_egomotion {

/// A bar on stderr, where that is a terminal.
class ProgressBar {
 public:
  explicit ProgressBar(std::size_t total) : total_(total), shown_(isatty(STDERR_FILENO) && total > 0) {}
  ~ProgressBar() {
    if (shown_) std::fputc('\n', stderr);
  }

  void advance() {
    ++done_;
    const int percent = shown_ ? static_cast<int>(100 * done_ / total_) : 0;
    if (percent == percent_) return;
    percent_ = percent;
    std::fprintf(stderr, "\r[%-50s] %3d %%", std::string(percent / 2, '=').c_str(), percent);
    std::fflush(stderr);
  }

 private:
  std::size_t total_, done_ = 0;
  bool shown_;
  int percent_ = 0;
};

}  // namespace multicam_egomotion
