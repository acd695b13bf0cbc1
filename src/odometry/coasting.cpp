// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "multicam_egomotion/odometry/coasting.h"

#include <algorithm>

namespace multicam_egomotion {
namespace {

constexpr std::int64_t kDefaultPeriod = 100000000;  // until it has been measured [ns]
constexpr std::int64_t kShortestPeriod = 1000000;   // of any camera; wrong stamps may be nearer to each other [ns]

}  // namespace

void Coasting::reset() { last_frame_ns_ = last_output_ns_ = last_vision_ns_ = 0; }

void Coasting::markFrame(std::int64_t stamp_ns, bool estimated) {
  if (last_frame_ns_ > 0) intervals_ns_[intervals_++ % intervals_ns_.size()] = stamp_ns - last_frame_ns_;
  last_frame_ns_ = last_output_ns_ = stamp_ns;
  if (estimated) last_vision_ns_ = stamp_ns;
}

std::int64_t Coasting::period() const {
  const int n = std::min<int>(intervals_, intervals_ns_.size());
  if (n == 0) return kDefaultPeriod;
  return std::max(kShortestPeriod, *std::min_element(intervals_ns_.begin(), intervals_ns_.begin() + n));
}

std::optional<std::int64_t> Coasting::nextTick(std::int64_t until_ns) const {
  const std::int64_t tick_ns = last_output_ns_ + period();
  if (last_frame_ns_ == 0 || tick_ns > until_ns || lost()) return std::nullopt;
  return tick_ns;
}

bool Coasting::framesMissingBefore(std::int64_t stamp_ns) const {
  return last_output_ns_ > last_frame_ns_ || 2 * (stamp_ns - last_frame_ns_) > 5 * period();
}

EgoMotionStatus Coasting::status(std::int64_t stamp_ns) const {
  const bool lost = 1e-9 * static_cast<double>(stamp_ns - last_vision_ns_) > max_coast_s_;
  return lost ? EgoMotionStatus::kLost : EgoMotionStatus::kCoasting;
}

}  // namespace multicam_egomotion
