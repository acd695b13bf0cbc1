// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace multicam_egomotion {

/// Data time: the newest stamp received. Late messages do not turn it back; two stamps in a row that agree on another
/// time, more than a second away, do: a single wrong stamp is no jump.
class DataClock {
 public:
  std::int64_t advance(std::int64_t stamp_ns) {
    if (stamp_ns <= 0) return now_ns_;
    const bool jump = started_ && !near(stamp_ns, now_ns_);
    if (!jump ? stamp_ns > now_ns_ : near(stamp_ns, elsewhere_ns_)) now_ns_ = stamp_ns;
    elsewhere_ns_ = jump ? stamp_ns : 0;
    started_ = true;
    return now_ns_;
  }

 private:
  static bool near(std::int64_t a, std::int64_t b) { return (a > b ? a - b : b - a) <= 1000000000; }

  bool started_ = false;
  std::int64_t now_ns_ = 0, elsewhere_ns_ = 0;
};

}  // namespace multicam_egomotion
