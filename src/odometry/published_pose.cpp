// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "multicam_egomotion/odometry/published_pose.h"

#include <algorithm>
#include <cmath>

#include "multicam_egomotion/geometry/covariance.h"
#include "multicam_egomotion/geometry/so3.h"
#include "multicam_egomotion/imu/imu_mounting.h"

namespace multicam_egomotion {
namespace {
constexpr double kOffsetDecay = 0.5;  // time constant [s], contract 6
constexpr double kTiltDecay = 2.0;    // [s]
constexpr double kIgnoredSigmas = 1.0;
}  // namespace

void PublishedPose::follow(const Eigen::Isometry3d& T_window_previous, const Eigen::Isometry3d& T_window_body,
                           double dt) {
  const double keep = std::exp(-dt / kOffsetDecay);
  // The difference between what was published and what the window says now of the same frame, seen from the body.
  const Eigen::Isometry3d difference = T_window_previous.inverse() * pose_;
  Eigen::Isometry3d kept = Eigen::Isometry3d::Identity();
  kept.linear() = expSO3(keep * logSO3(difference.linear()));
  kept.translation() = keep * difference.translation();
  const Eigen::Isometry3d moved = T_window_previous * kept * T_window_previous.inverse() * T_window_body;
  pose_.linear() = Eigen::Quaterniond(moved.linear()).normalized().toRotationMatrix();
  pose_.translation() = moved.translation();
}

Matrix6d propagateCovariance(const Matrix6d& covariance, const Eigen::Isometry3d& T_odom_previous,
                             const Eigen::Isometry3d& T_previous_body, const Matrix6d& motion_covariance) {
  Matrix6d F = Matrix6d::Identity();
  F.topRightCorner<3, 3>() = -skew(T_odom_previous.linear() * T_previous_body.translation());
  Matrix6d G = Matrix6d::Zero();
  G.topLeftCorner<3, 3>() = G.bottomRightCorner<3, 3>() = T_odom_previous.linear();
  return propagated(F, covariance) + propagated(G, motion_covariance);
}

Eigen::Matrix3d tiltCorrection(const Eigen::Matrix3d& R_odom_body, const Eigen::Vector3d& up, double sigma) {
  const Eigen::Vector3d error = shortestArc(R_odom_body * up, Eigen::Vector3d::UnitZ());
  const double angle = error.norm();
  const double excess = angle - kIgnoredSigmas * sigma;
  return excess > 0.0 ? expSO3(error * (excess / angle)) : Eigen::Matrix3d::Identity();
}

Eigen::Matrix3d slowed(const Eigen::Matrix3d& correction, double max_rate, double dt) {
  const Eigen::Vector3d vector = logSO3(correction);
  const double angle = vector.norm();
  if (angle < 1e-12) return Eigen::Matrix3d::Identity();
  return expSO3(vector * (std::min(angle * (1.0 - std::exp(-dt / kTiltDecay)), max_rate * dt) / angle));
}

}  // namespace multicam_egomotion
