// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <vector>

#include "multicam_egomotion/imu/imu_sample.h"

namespace multicam_egomotion {

/// What ImuBuffer::add did not use, by cause.
struct ImuFaults {
  std::uint64_t not_finite = 0;    ///< NaN, infinite or impossibly large rate or acceleration
  std::uint64_t zero_stamp = 0;    ///< stamp zero or negative
  std::uint64_t duplicate = 0;     ///< same stamp as the latest sample
  std::uint64_t out_of_order = 0;  ///< older than the latest sample
  std::uint64_t repeated = 0;      ///< the same six values at least twice before: a frozen sensor
  /// Refused samples; a repeated one is well-formed and tells at least that no later data are on their way.
  std::uint64_t total() const { return not_finite + zero_stamp + duplicate + out_of_order; }
};

/// IMU samples in strictly increasing time, bounded; the oldest are dropped when full.
class ImuBuffer {
 public:
  /// Throws std::invalid_argument if capacity < 2.
  explicit ImuBuffer(std::size_t capacity = 10000);

  /// False, and counted, if the sample is unusable (see ImuFaults). Repeated ones are a gap, unless repetition is what
  /// this source has always done (a driver that publishes faster than its sensor, a simulation at rest).
  bool add(const ImuSample& sample);

  /// Samples over [begin_ns, end_ns], interpolated linearly at both ends. Where the buffer does not cover the interval
  /// only the covered part is given (possibly nothing) and the answer is false. `samples` is cleared first.
  bool samplesBetween(std::int64_t begin_ns, std::int64_t end_ns, std::vector<ImuSample>* samples) const;

  /// Longest time in [begin_ns, end_ns] without a sample [s], uncovered time at its ends included; 0 if it is empty.
  double largestGap(std::int64_t begin_ns, std::int64_t end_ns) const;

  /// Time between the last sample before `stamp_ns` and the next one, or `stamp_ns` itself where there is none [s]; 0
  /// without a sample before.
  double spacingBefore(std::int64_t stamp_ns) const;

  /// Drops what is older than `stamp_ns`, but keeps the last sample at or before it so that interpolation there works.
  void prune(std::int64_t stamp_ns);
  /// Drops all samples; the counters stay.
  void clear();

  bool empty() const { return samples_.empty(); }
  std::size_t size() const { return samples_.size(); }
  std::int64_t oldestStamp() const { return samples_.empty() ? 0 : samples_.front().stamp_ns; }  ///< 0 when empty
  /// Up to here samples have come, repeated ones included; 0 when empty.
  std::int64_t latestStamp() const { return latest_stamp_ns_; }
  /// Of the latest sample that is used; 0 when empty.
  std::int64_t latestUsedStamp() const { return samples_.empty() ? 0 : samples_.back().stamp_ns; }
  const ImuFaults& faults() const { return faults_; }

 private:
  bool frozen(const ImuSample& sample);

  std::size_t capacity_;
  std::deque<ImuSample> samples_;
  std::int64_t latest_stamp_ns_ = 0;
  int run_ = 0;                                 // latest samples with the same values
  std::uint64_t changes_ = 0, same_again_ = 0;  // samples unlike and like the one before, those not used left out
  ImuFaults faults_;
};

/// Rate and acceleration interpolated linearly at `stamp_ns`; the orientation is that of the nearer sample.
ImuSample interpolate(const ImuSample& a, const ImuSample& b, std::int64_t stamp_ns);

}  // namespace multicam_egomotion
