// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>

#include "multicam_egomotion/odometry/ego_motion_result.h"

namespace multicam_egomotion {

/// What is known of the motion from one state to the next without vision (contract 6: IMU summary).
struct MotionSummary {
  Eigen::Isometry3d T_a_b = Eigen::Isometry3d::Identity();               ///< predicted motion of the body
  Eigen::Matrix3d rotation_covariance = Eigen::Matrix3d::Identity();     ///< of d in R = R_a_b Exp(d) [rad^2]
  Eigen::Matrix3d translation_covariance = Eigen::Matrix3d::Identity();  ///< in the axes of a [m^2]
  bool use_translation = false;  ///< vision could not see scale: the displacement enters the estimate
};

/// The motion from a to c of the motions a to b and b to c.
MotionSummary compose(const MotionSummary& a_b, const MotionSummary& b_c);

/// Covariance of the summary's motion, as PoseWithCovariance.
Matrix6d poseCovariance(const MotionSummary& motion);

}  // namespace multicam_egomotion
