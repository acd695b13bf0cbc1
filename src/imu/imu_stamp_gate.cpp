// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "multicam_egomotion/imu/imu_stamp_gate.h"

#include <algorithm>

namespace multicam_egomotion {
namespace {

double seconds(std::int64_t from_ns, std::int64_t to_ns) { return 1e-9 * static_cast<double>(to_ns - from_ns); }

}  // namespace

const std::vector<ImuSample>& ImuStampGate::pass(const ImuSample& sample) {
  passed_.clear();
  jumped_back_ = false;
  if (sample.stamp_ns <= 0) {  // says nothing of the time, the buffer counts it
    passed_.push_back(sample);
    return passed_;
  }
  const double since_latest = seconds(latest_ns_, sample.stamp_ns);
  const bool far = latest_ns_ > 0 && (since_latest < -kFarBack || since_latest > kFarAhead);
  if (waiting_) {
    const double since_waiting = seconds(waiting_->stamp_ns, sample.stamp_ns);
    if (far && since_waiting > 0.0 && since_waiting <= kFarAhead) {
      jumped_back_ = waiting_->stamp_ns < latest_ns_;
      passed_ = {*waiting_, sample};
      waiting_.reset();
      latest_ns_ = sample.stamp_ns;
      return passed_;
    }
    waiting_.reset();
    ++dropped_;
  }
  if (far) {
    waiting_ = sample;
    return passed_;
  }
  latest_ns_ = std::max(latest_ns_, sample.stamp_ns);
  passed_.push_back(sample);
  return passed_;
}

}  // namespace multicam_egomotion
