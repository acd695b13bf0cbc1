// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "multicam_egomotion/imu/gyroscope_check.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "multicam_egomotion/geometry/so3.h"
#include "multicam_egomotion/imu/gyroscope_integration.h"

namespace multicam_egomotion {
namespace {

constexpr double kDegree = M_PI / 180.0;
constexpr double kEnoughRotation = 30.0 * kDegree;
constexpr double kMemory = 10.0;           // time in which frames fade to 1/e [s]
constexpr double kLargestBias = 0.1;       // difference of the mean rates that may be a bias [rad/s]
constexpr double kOffsetReported = 0.005;  // [s]
constexpr double kDisagreement = 0.3;      // RMS difference, as a share of the rotation, that is no noise
constexpr double kWorthwhile = 0.5;  // the cost must fall below this share of what it is for another answer to count
constexpr int kMiddle = 12;

double shiftOf(int index) { return (index - kMiddle) * GyroscopeCheck::kLargestOffset / kMiddle; }

// The 48 matrices that permute and flip axes.
std::vector<Eigen::Matrix3d> allAxes() {
  std::vector<Eigen::Matrix3d> all;
  std::array<int, 3> order = {0, 1, 2};
  do {
    for (int signs = 0; signs < 8; ++signs) {
      Eigen::Matrix3d axes = Eigen::Matrix3d::Zero();
      for (int i = 0; i < 3; ++i) axes(i, order[i]) = signs >> i & 1 ? -1.0 : 1.0;
      all.push_back(axes);
    }
  } while (std::next_permutation(order.begin(), order.end()));
  return all;
}

}  // namespace

// Weighted sum of squared differences v - axes g, less what a constant bias explains.
double GyroscopeCheck::Sums::residual(const Eigen::Matrix3d& axes) const {
  const double all = vv + gg - 2.0 * axes.cwiseProduct(vg).sum();
  const double mean = (v - axes * g).norm();
  const double excess = std::max(0.0, mean - kLargestBias * seconds);
  return std::max(0.0, all - (mean * mean - excess * excess) / weight);
}

void GyroscopeCheck::add(std::int64_t stamp1_ns, std::int64_t stamp2_ns, const Eigen::Vector3d& vision,
                         const ImuBuffer& buffer) {
  const std::int64_t reach = static_cast<std::int64_t>(1e9 * kLargestOffset);
  const double duration = 1e-9 * static_cast<double>(stamp2_ns - stamp1_ns);
  if (!vision.allFinite() || !(duration > 0.0) || duration > 1.0 || buffer.empty() ||
      buffer.oldestStamp() > stamp1_ns - reach || buffer.latestStamp() < stamp2_ns + reach) {
    return;
  }
  const double kept = std::exp(-duration / kMemory);
  for (int i = 0; i < kShifts; ++i) {
    const std::int64_t shift = static_cast<std::int64_t>(1e9 * shiftOf(i));
    const Eigen::Vector3d g =
        logSO3(integrateGyroscope(buffer, stamp1_ns + shift, stamp2_ns + shift, Eigen::Vector3d::Zero(), 0.0).R_1_2);
    Sums& sums = shifted_[i];
    sums.weight = kept * sums.weight + 1.0;
    sums.seconds = kept * sums.seconds + duration;
    sums.v = kept * sums.v + vision;
    sums.g = kept * sums.g + g;
    sums.vv = kept * sums.vv + vision.squaredNorm();
    sums.gg = kept * sums.gg + g.squaredNorm();
    sums.vg = kept * sums.vg + vision * g.transpose();
  }
  rotation_ += vision.norm();
}

Eigen::Matrix3d GyroscopeCheck::bestAxes(double* residual) const {
  static const std::vector<Eigen::Matrix3d> candidates = allAxes();
  Eigen::Matrix3d best = Eigen::Matrix3d::Identity();
  *residual = shifted_[kMiddle].residual(best);
  for (const Eigen::Matrix3d& axes : candidates) {
    const double cost = shifted_[kMiddle].residual(axes);
    if (cost < *residual) {
      *residual = cost;
      best = axes;
    }
  }
  return best;
}

int GyroscopeCheck::bestShift() const {
  const Eigen::Matrix3d same = Eigen::Matrix3d::Identity();
  return static_cast<int>(
      std::min_element(shifted_.begin(), shifted_.end(),
                       [&](const Sums& a, const Sums& b) { return a.residual(same) < b.residual(same); }) -
      shifted_.begin());
}

double GyroscopeCheck::offset() const {
  if (rotation_ < kEnoughRotation) return 0.0;
  const Eigen::Matrix3d same = Eigen::Matrix3d::Identity();
  const int best = bestShift();
  const double cost = shifted_[best].residual(same);
  if (best == 0 || best == kShifts - 1) return shiftOf(best);
  const double before = shifted_[best - 1].residual(same), after = shifted_[best + 1].residual(same);
  const double curvature = before - 2.0 * cost + after;
  const double step = shiftOf(1) - shiftOf(0);
  return shiftOf(best) + (curvature > 0.0 ? 0.5 * step * (before - after) / curvature : 0.0);
}

GyroscopeCheck::State GyroscopeCheck::state() const {
  if (rotation_ < kEnoughRotation) return State::kNotCheckable;
  const Sums& now = shifted_[kMiddle];
  const Eigen::Matrix3d same = Eigen::Matrix3d::Identity();
  const double cost = now.residual(same);
  double other = 0.0;
  bestAxes(&other);
  if (cost > kDisagreement * kDisagreement * now.vv && other < kWorthwhile * cost) return State::kDisagrees;
  if (std::abs(offset()) > kOffsetReported && shifted_[bestShift()].residual(same) < kWorthwhile * cost) {
    return State::kDisagrees;
  }
  return cost > now.vv ? State::kDisagrees : State::kAgrees;
}

std::string GyroscopeCheck::report() const {
  char text[200];
  if (state() == State::kNotCheckable) {
    std::snprintf(text, sizeof(text), "not checkable yet (%.0f of %.0f deg of rotation)", rotation_ / kDegree,
                  kEnoughRotation / kDegree);
    return text;
  }
  if (state() == State::kAgrees) return "agrees with the images";
  const double cost = shifted_[kMiddle].residual(Eigen::Matrix3d::Identity());
  double other = 0.0;
  const Eigen::Matrix3d axes = bestAxes(&other);
  if (other < std::min(kWorthwhile * cost, shifted_[bestShift()].residual(Eigen::Matrix3d::Identity()))) {
    std::string is;
    for (int i = 0; i < 3; ++i) {
      int column = 0;
      axes.row(i).cwiseAbs().maxCoeff(&column);
      is += std::string(i ? ", " : "") + "xyz"[i] + " is " + (axes(i, column) < 0 ? "-" : "") + "xyz"[column];
    }
    return "disagrees with the images: axes of the IMU wrong (" + is + ")? check T_body_imu";
  }
  if (std::abs(offset()) > kOffsetReported) {
    std::snprintf(text, sizeof(text),
                  "disagrees with the images: clocks %.0f ms apart? check time_offset_s (t_imu = t_camera + offset)",
                  1e3 * offset());
    return text;
  }
  std::snprintf(text, sizeof(text),
                "disagrees with the images: rotations differ by %.0f %%, check the IMU's T_body_imu",
                100.0 * std::sqrt(cost / shifted_[kMiddle].vv));
  return text;
}

}  // namespace multicam_egomotion
