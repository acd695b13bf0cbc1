// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "multicam_egomotion/estimation/motion_priors.h"

#include "multicam_egomotion/geometry/so3.h"

namespace multicam_egomotion {

double addPriors(const MotionPriors& priors, const Eigen::Matrix3d& R, Eigen::Matrix<double, 6, 6>* H,
                 Eigen::Matrix<double, 6, 1>* g) {
  double cost = 0.0;
  auto H_theta = H->bottomRightCorner<3, 3>();
  auto g_theta = g->tail<3>();
  if (!priors.rotation.information.isZero(0.0)) {
    const Eigen::Vector3d d = logSO3(R * priors.rotation.R.transpose());
    const Eigen::Vector3d weighted = priors.rotation.information * d;
    const Eigen::Matrix3d J = inverseRightJacobianSO3(-d);  // of d by a left perturbation
    H_theta += J.transpose() * priors.rotation.information * J;
    g_theta += J.transpose() * weighted;
    cost += 0.5 * d.dot(weighted);
  }
  if (priors.tilt.information > 0.0) {
    const Eigen::Vector3d up = R * priors.tilt.up_body1;
    const Eigen::Vector3d d = up.cross(priors.tilt.up_body2);  // as long as the sine of the angle between them
    const Eigen::Matrix3d J = skew(priors.tilt.up_body2) * skew(up);
    H_theta += priors.tilt.information * J.transpose() * J;
    g_theta += priors.tilt.information * J.transpose() * d;
    cost += 0.5 * priors.tilt.information * d.squaredNorm();
  }
  if (priors.angle.information > 0.0) {
    const Eigen::Vector3d rotation = logSO3(R);
    const double angle = rotation.norm(), d = angle - priors.angle.angle;
    // At R = I the angle has no derivative.
    const Eigen::Vector3d axis = angle > 0.0 ? Eigen::Vector3d(rotation / angle) : Eigen::Vector3d::Zero();
    H_theta += priors.angle.information * axis * axis.transpose();
    g_theta += (priors.angle.information * d) * axis;
    cost += 0.5 * priors.angle.information * d * d;
  }
  return cost;
}

}  // namespace multicam_egomotion
