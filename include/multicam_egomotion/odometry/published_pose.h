// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>

#include "multicam_egomotion/odometry/ego_motion_result.h"

namespace multicam_egomotion {

/// The pose that leaves the odometry. It follows the window without repeating its corrections of the past as jumps:
/// they are held in an offset that decays (contract 6), and gravity turns it about the body slowly (contract 5).
class PublishedPose {
 public:
  void start(const Eigen::Isometry3d& T_odom_body) { pose_ = T_odom_body; }
  const Eigen::Isometry3d& pose() const { return pose_; }

  /// Follows the window from the previous frame to the newest one, `dt` later [s].
  void follow(const Eigen::Isometry3d& T_window_previous, const Eigen::Isometry3d& T_window_body, double dt);
  /// Goes on by a motion of the body.
  void move(const Eigen::Isometry3d& T_previous_body) { pose_ = pose_ * T_previous_body; }
  /// Turns the attitude by R (odom axes), the position stays.
  void turn(const Eigen::Matrix3d& R) { pose_.linear() = R * pose_.linear(); }

 private:
  Eigen::Isometry3d pose_ = Eigen::Isometry3d::Identity();
};

/// Covariance (as PoseWithCovariance) of a pose after a motion that is independent of it.
Matrix6d propagateCovariance(const Matrix6d& covariance, const Eigen::Isometry3d& T_odom_previous,
                             const Eigen::Isometry3d& T_previous_body, const Matrix6d& motion_covariance);

/// Rotation in odom axes that takes the vertical `up` (body axes, known to `sigma` per axis [rad]) of a body with
/// attitude R_odom_body towards z. The part of the error that is less than a sigma is left alone: to follow it
/// would only be to follow noise.
Eigen::Matrix3d tiltCorrection(const Eigen::Matrix3d& R_odom_body, const Eigen::Vector3d& up, double sigma);

/// `correction` low-pass filtered over two seconds, at most `max_rate` [rad/s] for `dt` [s].
Eigen::Matrix3d slowed(const Eigen::Matrix3d& correction, double max_rate, double dt);

}  // namespace multicam_egomotion
