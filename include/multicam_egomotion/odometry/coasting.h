// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "multicam_egomotion/odometry/ego_motion_result.h"

namespace multicam_egomotion {

/// Which stamps get a pose (contract 3): each frame, and ticks at the nominal rate while no frames come, until
/// max_coast_s after the last frame that vision could estimate.
class Coasting {
 public:
  explicit Coasting(double max_coast_s) : max_coast_s_(max_coast_s) {}

  /// As before the first frame: no ticks.
  void reset();
  /// A frame has its pose. `estimated`: by vision, or it is the first.
  void markFrame(std::int64_t stamp_ns, bool estimated);
  /// A pose went out at a stamp without a frame.
  void markTick(std::int64_t stamp_ns) { last_output_ns_ = stamp_ns; }

  /// The next tick, if it is due at `until_ns` and not LOST.
  std::optional<std::int64_t> nextTick(std::int64_t until_ns) const;
  /// More than one frame is missing before one at `stamp_ns`, or ticks have begun already.
  bool framesMissingBefore(std::int64_t stamp_ns) const;

  /// COASTING, or LOST where vision has been out for longer than max_coast_s.
  EgoMotionStatus status(std::int64_t stamp_ns) const;
  bool lost() const { return status(last_output_ns_) == EgoMotionStatus::kLost; }
  /// Nominal time between frames: the shortest of the last few intervals, as lost frames only widen them [ns].
  std::int64_t period() const;

 private:
  double max_coast_s_;
  std::int64_t last_frame_ns_ = 0, last_output_ns_ = 0, last_vision_ns_ = 0;
  std::array<std::int64_t, 4> intervals_ns_{};
  int intervals_ = 0;
};

}  // namespace multicam_egomotion
