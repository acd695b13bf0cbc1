// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "multicam_egomotion/odometry/motion_summary.h"

#include "multicam_egomotion/geometry/covariance.h"

namespace multicam_egomotion {

MotionSummary compose(const MotionSummary& a_b, const MotionSummary& b_c) {
  MotionSummary a_c;
  const Eigen::Matrix3d R_a_b = a_b.T_a_b.linear(), R_b_c = b_c.T_a_b.linear();
  a_c.T_a_b = a_b.T_a_b * b_c.T_a_b;
  a_c.rotation_covariance = propagated(R_b_c.transpose(), a_b.rotation_covariance) + b_c.rotation_covariance;
  a_c.translation_covariance = a_b.translation_covariance + propagated(R_a_b, b_c.translation_covariance);
  a_c.use_translation = a_b.use_translation || b_c.use_translation;
  return a_c;
}

Matrix6d poseCovariance(const MotionSummary& motion) {
  Matrix6d covariance = Matrix6d::Zero();
  covariance.topLeftCorner<3, 3>() = motion.translation_covariance;
  const Eigen::Matrix3d& R = motion.T_a_b.linear();
  covariance.bottomRightCorner<3, 3>() = propagated(R, motion.rotation_covariance);
  return covariance;
}

}  // namespace multicam_egomotion
