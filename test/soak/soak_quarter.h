// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <numeric>
#include <string>
#include <vector>

namespace multicam_egomotion {

/// Value of which a share is not larger; 0 of nothing.
inline double quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0.0;
  const auto nth = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), nth, values.end());
  return *nth;
}

/// What a quarter of a long run was like.
struct SoakQuarter {
  std::vector<double> cpu_ms, wall_ms;  ///< a frame
  std::vector<double> memory_mb;        ///< once a second of data
  std::vector<double> lap_error_m;      ///< distance between the ends of a lap, which are one place in truth
  std::uint64_t frames = 0, tracking = 0, faults = 0, warnings = 0;

  /// Takes the memory for the figures of so many frames now, so that they are no growth of what is measured.
  void reserve(std::size_t count) {
    for (std::vector<double>* figures : {&cpu_ms, &wall_ms, &memory_mb}) {
      figures->assign(count, 0.0);
      figures->clear();
    }
  }

  double memory() const {
    if (memory_mb.empty()) return 0.0;
    return std::accumulate(memory_mb.begin(), memory_mb.end(), 0.0) / static_cast<double>(memory_mb.size());
  }
  double p99() const { return quantile(cpu_ms, 0.99); }

  void print(int number) const {
    std::printf("%-8d %7llu %8llu %7.2f %7.2f %7.2f %7.2f %9.2f %7llu %8llu %9.3f\n", number,
                static_cast<unsigned long long>(frames), static_cast<unsigned long long>(tracking),
                quantile(cpu_ms, 0.5), p99(), quantile(wall_ms, 0.5), quantile(wall_ms, 0.99), memory(),
                static_cast<unsigned long long>(faults), static_cast<unsigned long long>(warnings),
                quantile(lap_error_m, 0.5));
    std::fflush(stdout);
  }
  static void printHeader() {
    std::printf("%-8s %7s %8s %7s %7s %7s %7s %9s %7s %8s %9s\n%-8s %7s %8s %7s %7s %7s %7s %9s %7s %8s %9s\n",
                "quarter", "frames", "tracking", "CPU", "p99", "wall", "p99", "memory", "faults", "warnings", "a lap",
                "", "", "", "[ms]", "[ms]", "[ms]", "[ms]", "[MB]", "", "", "[m]");
  }
};

/// Memory of this process that is no file's [MB].
inline double anonymousMemoryMb() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.rfind("RssAnon:", 0) == 0) return std::stod(line.substr(8)) / 1024.0;
  }
  return 0.0;
}

}  // namespace multicam_egomotion
