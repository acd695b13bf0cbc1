// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "multicam_egomotion/odometry/published_pose.h"

#include <algorithm>
#include <cmath>

#include "multicam_egomotion/geometry/so3.h"

namespace multicam_egomotion {
namespace {
constexpr double kOffsetDecay = 0.5;  // time constant [s], contract 6
constexpr double kTiltDecay = 2.0;    // [s]
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

Eigen::Matrix3d tiltCorrection(const Eigen::Matrix3d& R_odom_body, const Eigen::Vector3d& up, double max_rate,
                               double dt) {
  const Eigen::Vector3d up_odom = (R_odom_body * up).normalized();
  const Eigen::Vector3d axis = up_odom.cross(Eigen::Vector3d::UnitZ());
  const double angle = std::atan2(axis.norm(), up_odom.z());
  if (angle < 1e-9 || axis.norm() < 1e-12) return Eigen::Matrix3d::Identity();
  const double turn = std::min(angle * (1.0 - std::exp(-dt / kTiltDecay)), max_rate * dt);
  return expSO3(axis.normalized() * turn);
}

}  // namespace multicam_egomotion
