// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "multicam_egomotion/tracking/calibration_check.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstdio>

namespace multicam_egomotion {
namespace {

constexpr double kKept = 0.98;        // share of what was seen that a frame leaves
constexpr double kEnoughPairs = 100;  // so many tell something
constexpr double kRobustWidth = 5.0;  // distance from the line at which a pair counts a quarter [px]
constexpr double kTurnSigma = 0.1;    // of the turn, before anything is seen [rad]
constexpr double kReported = 0.7;     // distance from the lines that a turn makes, before matches are lost [px]

double degrees(double radians) { return radians * 180.0 / M_PI; }

}  // namespace

void CalibrationCheck::add(int a, const ImagePoint& in_a, int b, const ImagePoint& in_b,
                           const Eigen::Isometry3d& T_b_a) {
  if (a > b) return add(b, in_b, a, in_a, T_b_a.inverse());
  Eigen::Vector3d by_turn;
  const double error = epipolarError(in_a, in_b, T_b_a, &by_turn);
  const double weight = std::pow(1.0 + error * error / (kRobustWidth * kRobustWidth), -2);  // Geman and McClure
  Sums& sums = pairs_[{a, b}];
  sums.gg += weight * by_turn * by_turn.transpose();
  sums.ge += weight * error * by_turn;
  sums.ee += weight * error * error;
  sums.weight += weight;
  ++sums.count;
}

void CalibrationCheck::endFrame() {
  for (auto& [cameras, sums] : pairs_) {
    sums.gg *= kKept;
    sums.ge *= kKept;
    sums.ee *= kKept;
    sums.weight *= kKept;
    sums.count *= kKept;
  }
}

std::optional<CalibrationCheck::Turn> CalibrationCheck::turn(int a, int b) const {
  const auto found = pairs_.find({std::min(a, b), std::max(a, b)});
  if (found == pairs_.end() || found->second.count < kEnoughPairs) return std::nullopt;
  const Sums& sums = found->second;
  const Eigen::Matrix3d prior = Eigen::Matrix3d::Identity() / (kTurnSigma * kTurnSigma);
  const Eigen::Vector3d turn = (sums.gg + prior).ldlt().solve(-sums.ge);
  const double left = sums.ee + 2.0 * turn.dot(sums.ge) + turn.dot(sums.gg * turn);
  return Turn{turn.norm(), std::sqrt(turn.dot(sums.gg * turn) / sums.weight),
              std::sqrt(std::max(0.0, left) / sums.weight)};
}

std::vector<std::string> CalibrationCheck::faults() const {
  std::vector<std::string> all;
  for (const auto& [cameras, sums] : pairs_) {
    const std::optional<Turn> seen = turn(cameras.first, cameras.second);
    if (!seen || seen->explained_px < kReported || seen->explained_px < seen->left_px) continue;
    char text[60];
    std::snprintf(text, sizeof(text), ": turned by %.2f deg, matches %.1f px off", degrees(seen->angle),
                  seen->explained_px);
    all.push_back(rig_.camera(cameras.second).name + " disagrees with " + rig_.camera(cameras.first).name + text +
                  " their epipolar lines? check their extrinsics, intrinsics and exposure times");
  }
  return all;
}

}  // namespace multicam_egomotion
