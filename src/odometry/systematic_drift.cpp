// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "multicam_egomotion/odometry/systematic_drift.h"

#include <cmath>

#include "multicam_egomotion/geometry/so3.h"

namespace multicam_egomotion {
void SystematicDrift::follow(const Eigen::Vector3d& position, double tilt_variance, double scale_sigma) {
  const double scale_variance = scale_sigma * scale_sigma;
  if (scale_variance < scale_variance_) position_scale_ *= scale_variance / scale_variance_;
  scale_variance_ = scale_variance;
  if (started_) {
    const Eigen::Vector3d motion = position - position_;
    const Eigen::Matrix<double, 3, 2> by_tilt = -skew(motion).leftCols<2>();
    const Eigen::Matrix3d cross = by_tilt * position_tilt_.transpose();
    position_covariance_ += cross + cross.transpose() + tilt_variance_ * by_tilt * by_tilt.transpose();
    position_tilt_ += tilt_variance_ * by_tilt;
    const Eigen::Matrix3d scaled = motion * position_scale_.transpose();
    position_covariance_ += scaled + scaled.transpose() + scale_variance * motion * motion.transpose();
    position_scale_ += scale_variance * motion;
  }
  if (tilt_variance < tilt_variance_) position_tilt_ *= tilt_variance / tilt_variance_;
  tilt_variance_ = tilt_variance;
  position_ = position;
  started_ = true;
}

Matrix6d SystematicDrift::covariance() const {
  Matrix6d covariance = Matrix6d::Zero();
  covariance.topLeftCorner<3, 3>() = position_covariance_;
  covariance.block<3, 2>(0, 3) = position_tilt_;
  covariance.block<2, 3>(3, 0) = position_tilt_.transpose();
  covariance(3, 3) = covariance(4, 4) = tilt_variance_;
  return covariance;
}

}  // namespace multicam_egomotion
