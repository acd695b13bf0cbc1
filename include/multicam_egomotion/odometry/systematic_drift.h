// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "multicam_egomotion/odometry/ego_motion_result.h"

namespace multicam_egomotion {

/// What makes the accumulated pose wrong without averaging out over the frames, beside the random errors that the
/// window knows: the vertical, whose error turns all motion made under it, and the scale that calibration leaves.
/// First-order propagation of position, tilt and scale errors with their correlations; the correlation of the tilt
/// fades as new information makes the tilt better than it was.
class SystematicDrift {
 public:
  /// The body has moved to `position` (odom axes [m]) with an attitude whose vertical is known to `tilt_variance` per
  /// axis [rad^2]. The first call only says where it starts.
  void follow(const Eigen::Vector3d& position, double tilt_variance);

  /// As PoseWithCovariance; nothing about yaw.
  Matrix6d covariance() const;

 private:
  bool started_ = false;
  Eigen::Vector3d position_ = Eigen::Vector3d::Zero();
  double tilt_variance_ = 0.0;
  Eigen::Matrix3d position_covariance_ = Eigen::Matrix3d::Zero();
  Eigen::Matrix<double, 3, 2> position_tilt_ = Eigen::Matrix<double, 3, 2>::Zero();  // with rx, ry
  Eigen::Vector3d moved_ = Eigen::Vector3d::Zero();                                  // since the start
};

}  // namespace multicam_egomotion
