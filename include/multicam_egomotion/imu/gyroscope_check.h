// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string>

#include "multicam_egomotion/imu/imu_buffer.h"

namespace multicam_egomotion {

/// Compares the rotations that the gyroscope and the images alone measure between frames, and finds wrong axes (any of
/// the 48 ways to permute and flip them) and an offset between the two clocks. A constant gyroscope bias does no harm.
/// Old frames fade out. The search is over whole turns of the axes only: small errors of the extrinsic rotation are not
/// looked for.
class GyroscopeCheck {
 public:
  enum class State { kNotCheckable, kAgrees, kDisagrees };

  /// Rotation from the frame at `stamp1_ns` to that at `stamp2_ns` (clock of the IMU) by the images alone, as a
  /// rotation vector in the axes of the IMU [rad]. The buffer should reach kLargestOffset to both sides; else the frame
  /// is left out.
  void add(std::int64_t stamp1_ns, std::int64_t stamp2_ns, const Eigen::Vector3d& vision, const ImuBuffer& buffer);
  void reset() { *this = GyroscopeCheck(); }

  State state() const;
  /// "not checkable yet (12 of 30 deg)", "agrees", or what is wrong and what would be right.
  std::string report() const;
  /// Offset of the clocks, t_imu = t_camera + offset [s], where it is seen; 0 before.
  double offset() const;

  static constexpr double kLargestOffset = 0.06;  ///< that is searched for [s]

 private:
  static constexpr int kShifts = 25;
  // Sums over frames, fading: of vision v and gyroscope g, both minus nothing; the mean difference is the bias.
  struct Sums {
    double weight = 0.0, seconds = 0.0;
    Eigen::Vector3d v = Eigen::Vector3d::Zero(), g = Eigen::Vector3d::Zero();
    double vv = 0.0, gg = 0.0;
    Eigen::Matrix3d vg = Eigen::Matrix3d::Zero();

    double residual(const Eigen::Matrix3d& axes) const;
  };

  int bestShift() const;
  Eigen::Matrix3d bestAxes(double* residual) const;

  std::array<Sums, kShifts> shifted_;
  double rotation_ = 0.0;  ///< accumulated [rad]
};

}  // namespace multicam_egomotion
