// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "multicam_egomotion/imu/imu_sample.h"

namespace multicam_egomotion {

/// Looks at the samples of an IMU as they arrive for what no filter can make good: wrong units, values that stand
/// still, are not finite or at the end of the range, and a rate far below the calibrated one. Judges one second of data
/// at a time; what it found stands until the next second has been judged.
class ImuMonitor {
 public:
  /// `rate_hz`: of the calibration; `gravity` [m/s^2].
  ImuMonitor(double rate_hz, double gravity) : rate_hz_(rate_hz), gravity_(gravity) {}

  /// Any sample, in the order of arrival, also one that the buffer refuses.
  void add(const ImuSample& sample);
  /// Forgets all samples, as when the clock jumps.
  void reset();

  /// What is wrong, each as one line that says what was found and what was expected; empty when nothing is.
  const std::vector<std::string>& faults() const { return faults_; }

 private:
  void judge(double duration_s);

  double rate_hz_, gravity_;
  std::vector<std::string> faults_;
  bool gravity_seen_ = false;  ///< in m/s^2: what is less later is free fall

  // Of the second that is being collected.
  std::int64_t start_ns_ = 0, last_ns_ = 0;
  int samples_ = 0, not_finite_ = 0, repeated_ = 0;
  double force_sum_ = 0.0;
  Eigen::Matrix<double, 6, 1> last_ = Eigen::Matrix<double, 6, 1>::Zero();
  Eigen::Matrix<double, 6, 1> largest_ = Eigen::Matrix<double, 6, 1>::Zero();  ///< magnitude, by channel
  Eigen::Matrix<int, 6, 1> at_limit_ = Eigen::Matrix<int, 6, 1>::Zero();       ///< how often it repeats itself
};

}  // namespace multicam_egomotion
