// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "multicam_egomotion/imu/imu_sample.h"

namespace multicam_egomotion {

/// Tells a jump of the IMU's clock from a sample with a wrong stamp: one whose stamp is far from the one before waits
/// for the next. If that goes on from there both pass, and the clock has jumped or data are missing; if not, the one
/// that waited is dropped.
class ImuStampGate {
 public:
  static constexpr double kFarBack = 0.1;   ///< stamps out of order are not further back than this [s]
  static constexpr double kFarAhead = 1.0;  ///< [s]

  /// Samples that `sample` lets pass, in the order of arrival: none, it alone, or one that waited and it.
  const std::vector<ImuSample>& pass(const ImuSample& sample);
  /// The first of the samples that passed last is the first after a jump back.
  bool jumpedBack() const { return jumped_back_; }
  /// The newest sample waits, and is behind those that passed.
  bool waitsBehind() const { return waiting_ && waiting_->stamp_ns < latest_ns_; }
  std::uint64_t dropped() const { return dropped_; }

 private:
  std::int64_t latest_ns_ = 0;  ///< of those that passed
  std::optional<ImuSample> waiting_;
  std::vector<ImuSample> passed_;
  bool jumped_back_ = false;
  std::uint64_t dropped_ = 0;
};

}  // namespace multicam_egomotion
