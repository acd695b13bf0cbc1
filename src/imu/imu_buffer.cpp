// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "multicam_egomotion/imu/imu_buffer.h"

#include <algorithm>
#include <stdexcept>
#include <string>

namespace multicam_egomotion {
namespace {

constexpr int kFrozenRun = 3;  // equal samples that no live sensor gives

bool earlier(const ImuSample& sample, std::int64_t stamp_ns) { return sample.stamp_ns < stamp_ns; }

}  // namespace

ImuSample interpolate(const ImuSample& a, const ImuSample& b, std::int64_t stamp_ns) {
  const double span = static_cast<double>(b.stamp_ns - a.stamp_ns);
  const double weight = span > 0 ? static_cast<double>(stamp_ns - a.stamp_ns) / span : 0.0;
  ImuSample sample = weight < 0.5 ? a : b;
  sample.stamp_ns = stamp_ns;
  sample.angular_velocity = (1 - weight) * a.angular_velocity + weight * b.angular_velocity;
  sample.linear_acceleration = (1 - weight) * a.linear_acceleration + weight * b.linear_acceleration;
  return sample;
}

ImuBuffer::ImuBuffer(std::size_t capacity) : capacity_(capacity) {
  if (capacity < 2) {
    throw std::invalid_argument("ImuBuffer capacity: found " + std::to_string(capacity) + ", expected at least 2");
  }
}

bool ImuBuffer::add(const ImuSample& sample) {
  if (!plausible(sample)) {
    ++faults_.not_finite;
    return false;
  }
  if (sample.stamp_ns <= 0) {
    ++faults_.zero_stamp;
    return false;
  }
  if (!samples_.empty() && sample.stamp_ns <= latest_stamp_ns_) {
    ++(sample.stamp_ns == latest_stamp_ns_ ? faults_.duplicate : faults_.out_of_order);
    return false;
  }
  latest_stamp_ns_ = sample.stamp_ns;
  if (frozen(sample)) {
    ++faults_.repeated;
    return false;
  }
  if (samples_.size() == capacity_) {
    samples_.pop_front();
  }
  samples_.push_back(sample);
  return true;
}

bool ImuBuffer::frozen(const ImuSample& sample) {
  const bool same = !samples_.empty() && sample.angular_velocity == samples_.back().angular_velocity &&
                    sample.linear_acceleration == samples_.back().linear_acceleration;
  run_ = same ? run_ + 1 : 1;
  if (run_ >= kFrozenRun && changes_ > same_again_) return true;
  ++(same ? same_again_ : changes_);
  return false;
}

void ImuBuffer::clear() {
  samples_.clear();
  latest_stamp_ns_ = 0;
  run_ = 0;
}

bool ImuBuffer::samplesBetween(std::int64_t begin_ns, std::int64_t end_ns, std::vector<ImuSample>* samples) const {
  samples->clear();
  if (samples_.empty() || end_ns < begin_ns || end_ns < oldestStamp() || begin_ns > latestUsedStamp()) {
    return false;
  }
  auto sample = std::lower_bound(samples_.begin(), samples_.end(), begin_ns, earlier);
  if (sample->stamp_ns > begin_ns && sample != samples_.begin()) {
    samples->push_back(interpolate(*(sample - 1), *sample, begin_ns));
  }
  for (; sample != samples_.end() && sample->stamp_ns <= end_ns; ++sample) {
    samples->push_back(*sample);
  }
  if (sample != samples_.end() && samples->back().stamp_ns < end_ns) {
    samples->push_back(interpolate(*(sample - 1), *sample, end_ns));
  }
  return begin_ns >= oldestStamp() && end_ns <= latestUsedStamp();
}

double ImuBuffer::largestGap(std::int64_t begin_ns, std::int64_t end_ns) const {
  std::int64_t largest = 0;
  std::int64_t previous = begin_ns;
  auto sample = std::lower_bound(samples_.begin(), samples_.end(), begin_ns, earlier);
  for (; sample != samples_.end() && sample->stamp_ns <= end_ns; ++sample) {
    largest = std::max(largest, sample->stamp_ns - previous);
    previous = sample->stamp_ns;
  }
  return 1e-9 * static_cast<double>(std::max(largest, end_ns - previous));
}

double ImuBuffer::spacingBefore(std::int64_t stamp_ns) const {
  const auto next = std::lower_bound(samples_.begin(), samples_.end(), stamp_ns, earlier);
  if (next == samples_.begin()) return 0.0;
  const std::int64_t end_ns = next == samples_.end() ? stamp_ns : next->stamp_ns;
  return 1e-9 * static_cast<double>(end_ns - (next - 1)->stamp_ns);
}

void ImuBuffer::prune(std::int64_t stamp_ns) {
  while (samples_.size() >= 2 && samples_[1].stamp_ns <= stamp_ns) {
    samples_.pop_front();
  }
}

}  // namespace multicam_egomotion
