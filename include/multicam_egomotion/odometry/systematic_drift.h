// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "multicam_egomotion/odometry/ego_motion_result.h"

namespace multicam_egomotion {

/// What makes the accumulated pose wrong without averaging out over the frames, beside the random errors that the
/// window knows: the vertical, whose error turns all motion made under it, and the scale, as calibration leaves it or,
/// where the images hardly show it, as it was last known.
/// First-order propagation of position, tilt and scale errors; the correlation of tilt and scale with the position
/// fades as new information makes them better than they were.
class SystematicDrift {
 public:
  /// The body has moved to `position` (odom axes [m]) with an attitude whose vertical is known to `tilt_variance` per
  /// axis [rad^2], and lengths to `scale_sigma` [1] with the same error from frame to frame. The first call only says
  /// where it starts.
  void follow(const Eigen::Vector3d& position, double tilt_variance, double scale_sigma = 0.0);

  /// As PoseWithCovariance; nothing about yaw.
  Matrix6d covariance() const;

 private:
  bool started_ = false;
  Eigen::Vector3d position_ = Eigen::Vector3d::Zero();
  double tilt_variance_ = 0.0;
  Eigen::Matrix3d position_covariance_ = Eigen::Matrix3d::Zero();
  Eigen::Matrix<double, 3, 2> position_tilt_ = Eigen::Matrix<double, 3, 2>::Zero();  // with rx, ry
  double scale_variance_ = 0.0;
  Eigen::Vector3d position_scale_ = Eigen::Vector3d::Zero();  // covariance with the scale
};

}  // namespace multicam_egomotion
