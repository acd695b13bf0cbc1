// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <functional>

#include "simulator/time_jet.h"

namespace multicam_egomotion {

/// Position [m] and z-y-x Euler angles [rad] of a moving frame in a z-up world.
struct MotionJet {
  TimeJet x, y, z;
  TimeJet yaw, pitch, roll;
};

/// State of the body at one instant.
struct BodyState {
  Eigen::Isometry3d T_world_body;
  Eigen::Vector3d velocity;              ///< of the body origin, world axes [m/s]
  Eigen::Vector3d acceleration;          ///< of the body origin, world axes [m/s^2]
  Eigen::Vector3d angular_velocity;      ///< body axes [rad/s]
  Eigen::Vector3d angular_acceleration;  ///< body axes [rad/s^2]

  /// Acceleration of a point fixed in the body [m, body axes], world axes [m/s^2].
  Eigen::Vector3d accelerationOf(const Eigen::Vector3d& point) const;
};

/// Motion of the body as an analytic function of time; every derivative is exact.
class Trajectory {
 public:
  using Motion = std::function<MotionJet(const TimeJet& time)>;

  /// `motion` moves a frame to which the body is fixed with rotation `R_motion_body` (same origin).
  explicit Trajectory(Motion motion, const Eigen::Matrix3d& R_motion_body = Eigen::Matrix3d::Identity());

  BodyState at(double time_s) const;

  /// Length of the path of the body origin [m].
  double pathLength(double from_s, double to_s) const;

 private:
  Motion motion_;
  Eigen::Matrix3d R_motion_body_;
};

}  // namespace multicam_egomotion
