// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "multicam_egomotion/odometry/learned_motion.h"

#include <algorithm>

namespace multicam_egomotion {
namespace {

constexpr double kFarDistance = 20.0;       // what does not move in the images is taken to be no further away [m]
constexpr double kUnknownDistance = 100.0;  // sigma of a displacement of which only the direction is seen [m]
constexpr double kStillParallax = 0.1;      // image motion that cannot be told from none [px]
constexpr double kLastingFrames = 25.0;     // that share an error of the scale

double square(double x) { return x * x; }

}  // namespace

LearnedMotion learnedMotion(const WindowEstimate& estimate, const Eigen::Vector3d& predicted, bool scale_seen,
                            double parallax_px, double focal_length) {
  const double seen = estimate.vision.T_a_b.translation().norm();
  const bool standing = estimate.scale_state == ScaleState::kNotApplicable;
  LearnedMotion learned{estimate.vision, true};
  Eigen::Isometry3d& T = learned.vision.T_a_b;
  Eigen::Ref<Eigen::Matrix3d> covariance = learned.vision.covariance.topLeftCorner<3, 3>();
  if (standing && !scale_seen) {
    const double sigma = kFarDistance * std::max(parallax_px, kStillParallax) / focal_length;
    T.translation().setZero();
    covariance = sigma * sigma * Eigen::Matrix3d::Identity();
  } else if (!standing && estimate.scale_state != ScaleState::kObservable) {
    const Eigen::Vector3d direction = T.translation() / std::max(seen, 1e-9);
    const double distance = direction.dot(predicted);
    learned.use_displacement = seen > 1e-9 && distance > 0.0;
    const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - direction * direction.transpose();
    T.translation() = distance * direction;
    covariance = (across * covariance * across * (distance * distance / (seen * seen)) +
                  kUnknownDistance * kUnknownDistance * direction * direction.transpose())
                     .eval();
  } else if (!standing && seen > 1e-9) {
    // What the motion itself is worse known along than across is the points' distances, which stay the same from frame
    // to frame: such an error does not average out, and while it shrinks it looks like an acceleration.
    const Eigen::Vector3d direction = T.translation() / seen;
    const double across = 0.5 * (covariance.trace() - direction.dot(covariance * direction));
    const double lasting = std::max(0.0, square(estimate.scale_noise * seen) - across);
    covariance += kLastingFrames * square(kUnderstatedScale) * lasting * direction * direction.transpose();
  }
  return learned;
}

}  // namespace multicam_egomotion
