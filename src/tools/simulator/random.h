// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>

namespace multicam_egomotion {

/// Seeded pseudo-random numbers, the same on every platform (SplitMix64; Steele, Lea, Flood 2014).
class Random {
 public:
  /// Streams of one seed are independent of each other.
  explicit Random(std::uint64_t seed, std::uint64_t stream = 0) : state_(seed * 0x9E3779B97F4A7C15ull + 1) {
    state_ = next() ^ (stream * 0xD1B54A32D192ED03ull + 0x8CB92BA72F3D8DD7ull);
    next();
  }

  std::uint64_t next() {
    std::uint64_t z = (state_ += 0x9E3779B97F4A7C15ull);
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ull;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBull;
    return z ^ (z >> 31);
  }

  /// Uniform in [low, high).
  double uniform(double low = 0.0, double high = 1.0) { return low + (high - low) * ((next() >> 11) * 0x1.0p-53); }

  /// Uniform in {0, ..., count - 1}.
  int index(int count) { return static_cast<int>(uniform() * count); }

  /// Standard normal (Box-Muller).
  double gaussian() {
    const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform()));
    return radius * std::cos(2.0 * M_PI * uniform());
  }

  Eigen::Vector3d gaussian3() {
    const double x = gaussian(), y = gaussian(), z = gaussian();
    return {x, y, z};
  }

 private:
  std::uint64_t state_;
};

}  // namespace multicam_egomotion
