// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "simulator/trajectory.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace multicam_egomotion {

namespace {

/// A rotation matrix with its first and second time derivative.
struct RotationJet {
  Eigen::Matrix3d value, rate, acceleration;
};

RotationJet rotationAbout(const Eigen::Vector3d& axis, const TimeJet& angle) {
  RotationJet r;
  Eigen::Matrix3d k;
  k << 0, -axis.z(), axis.y(), axis.z(), 0, -axis.x(), -axis.y(), axis.x(), 0;
  r.value = Eigen::AngleAxisd(angle.value, axis).toRotationMatrix();
  const Eigen::Matrix3d d = k * r.value;
  r.rate = d * angle.rate;
  r.acceleration = d * angle.acceleration + k * d * (angle.rate * angle.rate);
  return r;
}

RotationJet operator*(const RotationJet& a, const RotationJet& b) {
  return {a.value * b.value, a.rate * b.value + a.value * b.rate,
          a.acceleration * b.value + 2.0 * a.rate * b.rate + a.value * b.acceleration};
}

Eigen::Vector3d vee(const Eigen::Matrix3d& m) {
  return 0.5 * Eigen::Vector3d(m(2, 1) - m(1, 2), m(0, 2) - m(2, 0), m(1, 0) - m(0, 1));
}

}  // namespace

Eigen::Vector3d BodyState::accelerationOf(const Eigen::Vector3d& point) const {
  return acceleration + T_world_body.linear() *
                            (angular_acceleration.cross(point) + angular_velocity.cross(angular_velocity.cross(point)));
}

Trajectory::Trajectory(Motion motion, const Eigen::Matrix3d& R_motion_body)
    : motion_(std::move(motion)), R_motion_body_(R_motion_body) {}

BodyState Trajectory::at(double time_s) const {
  const MotionJet m = motion_(TimeJet::time(time_s));
  RotationJet R = rotationAbout(Eigen::Vector3d::UnitZ(), m.yaw) * rotationAbout(Eigen::Vector3d::UnitY(), m.pitch) *
                  rotationAbout(Eigen::Vector3d::UnitX(), m.roll);
  R = {R.value * R_motion_body_, R.rate * R_motion_body_, R.acceleration * R_motion_body_};

  BodyState state;
  state.T_world_body.setIdentity();
  state.T_world_body.linear() = R.value;
  state.T_world_body.translation() << m.x.value, m.y.value, m.z.value;
  state.velocity << m.x.rate, m.y.rate, m.z.rate;
  state.acceleration << m.x.acceleration, m.y.acceleration, m.z.acceleration;
  // R' = R [w]x, hence [w]x = RᵀR' and [w']x = skew part of RᵀR''.
  state.angular_velocity = vee(R.value.transpose() * R.rate);
  state.angular_acceleration = vee(R.value.transpose() * R.acceleration);
  return state;
}

double Trajectory::pathLength(double from_s, double to_s) const {
  const int steps = std::max(1, static_cast<int>(std::ceil((to_s - from_s) * 500.0)));
  const double step = (to_s - from_s) / steps;
  double length = 0.0;
  for (int i = 0; i < steps; ++i) length += step * at(from_s + (i + 0.5) * step).velocity.norm();
  return length;
}

}  // namespace multicam_egomotion
