// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

namespace multicam_egomotion {

/// Gaussian knowledge of the rotation R_f2_f1 (gyroscope, or constant rate): R_true = Exp(d) R, d ~ N(0, covariance).
struct RotationPrior {
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();  ///< [1/rad^2]; zero: nothing is known
};

/// Gaussian knowledge of the vertical: R_f2_f1 turns up_body1 into up_body2 (unit vectors), up to an angle of
/// standard deviation 1 / sqrt(information) about each horizontal axis. The yaw stays free.
struct TiltPrior {
  Eigen::Vector3d up_body1 = Eigen::Vector3d::UnitZ();
  Eigen::Vector3d up_body2 = Eigen::Vector3d::UnitZ();
  double information = 0.0;  ///< [1/rad^2]; zero: nothing is known
};

/// Gaussian knowledge of the angle of R_f2_f1.
struct RotationAnglePrior {
  double angle = 0.0;        ///< [rad], in [0, pi]
  double information = 0.0;  ///< [1/rad^2]; zero: nothing is known
};

/// What is known of the rotation besides the images; all of it enters the refinement.
struct MotionPriors {
  RotationPrior rotation;
  TiltPrior tilt;
  RotationAnglePrior angle;
};

/// Adds the priors to the normal equations of (d t, d theta), R <- Exp(d theta) R: H to first order, gradient g of the
/// cost. Returns their cost, half the sum of squares in sigmas.
double addPriors(const MotionPriors& priors, const Eigen::Matrix3d& R, Eigen::Matrix<double, 6, 6>* H,
                 Eigen::Matrix<double, 6, 1>* g);

}  // namespace multicam_egomotion
