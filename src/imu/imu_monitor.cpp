// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "multicam_egomotion/imu/imu_monitor.h"

#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstdio>

namespace multicam_egomotion {
namespace {

using Vector6d = Eigen::Matrix<double, 6, 1>;

constexpr double kSpan = 1.0;              // of data judged at a time [s]
constexpr double kLeastLimitRate = 0.2;    // no gyroscope is at its limit below this [rad/s]
constexpr double kLeastLimitForce = 12.0;  // nor an accelerometer [m/s^2]
constexpr double kLeastRateShare = 0.5;    // of the calibrated rate
constexpr double kLeastShare = 0.05;       // of the samples, that repeat the largest value
constexpr const char* kChannels[] = {"angular velocity x",    "angular velocity y",    "angular velocity z",
                                     "linear acceleration x", "linear acceleration y", "linear acceleration z"};

std::string text(const char* format, ...) {
  char buffer[200];
  va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(buffer, sizeof(buffer), format, arguments);
  va_end(arguments);
  return buffer;
}

}  // namespace

void ImuMonitor::reset() {
  const bool gravity_seen = gravity_seen_;
  *this = ImuMonitor(rate_hz_, gravity_);
  gravity_seen_ = gravity_seen;
}

void ImuMonitor::add(const ImuSample& sample) {
  if (sample.stamp_ns <= 0) return;
  if (sample.stamp_ns < start_ns_) reset();
  if (start_ns_ == 0) start_ns_ = sample.stamp_ns;
  const double duration = 1e-9 * static_cast<double>(sample.stamp_ns - start_ns_);
  if (duration >= kSpan) {
    judge(duration);
    start_ns_ = sample.stamp_ns;
    samples_ = not_finite_ = repeated_ = 0;
    force_sum_ = 0.0;
    largest_.setZero();
    at_limit_.setZero();
  }
  ++samples_;
  if (!plausible(sample)) {
    ++not_finite_;
    return;
  }
  Vector6d values;
  values << sample.angular_velocity, sample.linear_acceleration;
  force_sum_ += sample.linear_acceleration.norm();
  if (sample.stamp_ns != last_ns_) {
    repeated_ += values == last_;
    for (int i = 0; i < 6; ++i) {
      const double magnitude = std::abs(values[i]);
      if (magnitude > largest_[i]) at_limit_[i] = 0;
      largest_[i] = std::max(largest_[i], magnitude);
      at_limit_[i] += values[i] == last_[i] && magnitude == largest_[i];
    }
  }
  last_ = values;
  last_ns_ = sample.stamp_ns;
}

void ImuMonitor::judge(double duration_s) {
  faults_.clear();
  const double rate = samples_ / duration_s;
  if (rate < kLeastRateShare * rate_hz_) {
    faults_.push_back(
        text("IMU: %.0f samples in %.1f s, expected %.0f Hz", static_cast<double>(samples_), duration_s, rate_hz_));
  }
  if (not_finite_ > 0)
    faults_.push_back(text("IMU: %d of %d samples not finite or larger than any sensor's", not_finite_, samples_));
  const int finite = samples_ - not_finite_;
  if (finite == 0) return;
  if (repeated_ > 0.5 * finite) {
    faults_.push_back(text("IMU: %d of %d samples repeat the one before: frozen?", repeated_, finite));
    return;
  }
  const double force = force_sum_ / finite;
  gravity_seen_ = gravity_seen_ || (force > 0.5 * gravity_ && force < 2.0 * gravity_);
  if (!gravity_seen_ && force > 0.5 && force < 2.0) {
    faults_.push_back(text("IMU: mean acceleration %.2f, expected about %.1f m/s^2: in g?", force, gravity_));
  }
  for (int i = 0; i < 6; ++i) {
    if (largest_[i] > (i < 3 ? kLeastLimitRate : kLeastLimitForce) && at_limit_[i] > kLeastShare * finite + 1.0) {
      faults_.push_back(text("IMU: %s stays at %.2f in %d of %d samples: saturated?", kChannels[i], largest_[i],
                             at_limit_[i], finite));
    }
  }
}

}  // namespace multicam_egomotion
