// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "multicam_egomotion/odometry/window_marginals.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "multicam_egomotion/geometry/covariance.h"
#include "multicam_egomotion/geometry/so3.h"

namespace multicam_egomotion {
namespace {

constexpr double kObservableScale = 0.1, kWeakScale = 0.5;  // contract 7
constexpr double kWeakestInformation =
    1e-6;  // stands for "unknown" (sigma 1000 m or rad) where a direction is not seen

// Calibration and tracking leave errors that do not average out over a window; scale is not seen through less [px].
constexpr double kSystematicError = 0.25;
// What all tracks have in common: error of the scale as a share (patches on slanted surfaces and at edges, the
// baseline) and of the direction (mounting of the cameras) [rad].
constexpr double kCommonScaleError = 8e-4;
constexpr double kCommonDirectionError = 2e-4;
constexpr double kEvenlySeen = 5.0;      // ratio of the noise along and across up to which all directions count as seen
constexpr double kContradiction = 10.0;  // sigmas by which the images' rotation differs from a wrong prior
constexpr double kUnknownInverseDistance = 100.0;  // sigma that says nothing of a point's distance [1/m]

using Matrix6x12d = Eigen::Matrix<double, 6, 12>;

Eigen::Matrix3d commonErrors(const Eigen::Vector3d& p) {
  const double scale = kCommonScaleError * kCommonScaleError, direction = kCommonDirectionError * kCommonDirectionError;
  return direction * p.squaredNorm() * Eigen::Matrix3d::Identity() + (scale - direction) * p * p.transpose();
}

// d(position, rotation) of T_a_b, as PoseWithCovariance defines it, by the local perturbations (dp, dtheta) of a and b.
Matrix6x12d relativeJacobian(const BundlePose& a, const BundlePose& b) {
  const Eigen::Matrix3d R = a.R.transpose() * b.R;
  const Eigen::Vector3d p = a.R.transpose() * (b.p - a.p);
  Matrix6x12d J = Matrix6x12d::Zero();
  J.block<3, 3>(0, 0) = -Eigen::Matrix3d::Identity();
  J.block<3, 3>(0, 3) = skew(p);
  J.block<3, 3>(0, 6) = R;
  J.block<3, 3>(3, 3) = -Eigen::Matrix3d::Identity();
  J.block<3, 3>(3, 9) = R;
  return J;
}

Eigen::Isometry3d relativePose(const BundlePose& a, const BundlePose& b) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = a.R.transpose() * b.R;
  T.translation() = a.R.transpose() * (b.p - a.p);
  return T;
}

// Solution and covariance of the last two poses with the first pose fixed.
struct LastTwo {
  Eigen::Matrix<double, 12, 1> step = Eigen::Matrix<double, 12, 1>::Zero();
  Eigen::Matrix<double, 12, 12> covariance = Eigen::Matrix<double, 12, 12>::Zero();
};

LastTwo solveLastTwo(const Eigen::MatrixXd& H, const Eigen::VectorXd& b, int fixed) {
  LastTwo result;
  const int size = static_cast<int>(H.rows()) - fixed;
  Eigen::MatrixXd free = H.bottomRightCorner(size, size);
  free.diagonal().array() += kWeakestInformation;
  const int count = std::min(size, 12);
  Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(size, count + 1);
  columns.bottomLeftCorner(count, count).setIdentity();
  columns.col(count) = b.tail(size);
  columns = symmetricSolve(free, columns);
  result.covariance.bottomRightCorner(count, count) = columns.bottomLeftCorner(count, count);
  result.step.tail(count) = columns.col(count).tail(count);
  result.covariance = 0.5 * (result.covariance + result.covariance.transpose()).eval();
  return result;
}

}  // namespace

void computeMarginals(BundleAdjustment* bundle, const BundleOptions& solve_options, double white_share,
                      WindowEstimate* estimate) {
  BundleOptions options = solve_options;
  options.inverse_distance_sigma = kUnknownInverseDistance;
  Eigen::MatrixXd vision_H, rest_H;
  Eigen::VectorXd vision_b, rest_b;
  bundle->linearize(&vision_H, &vision_b, &rest_H, &rest_b, options);
  const double newton_gain = bundle->newtonGain();
  const int n = static_cast<int>(bundle->poses.size());
  const BundlePose& previous = bundle->poses[n - 2];
  const BundlePose& newest = bundle->poses[n - 1];
  const Matrix6x12d J = relativeJacobian(previous, newest);

  // From everything.
  const LastTwo all = solveLastTwo(vision_H + rest_H, vision_b + rest_b, 0);
  Matrix6d to_odom = Matrix6d::Zero();
  to_odom.topLeftCorner<3, 3>() = to_odom.bottomRightCorner<3, 3>() = newest.R;
  estimate->covariance = propagated(to_odom, all.covariance.bottomRightCorner<6, 6>());

  const double systematic = std::pow(bundle->pixel_sigma / std::max(bundle->pixel_sigma, kSystematicError), 2);
  const Eigen::MatrixXd scale_H = systematic * vision_H;

  // Between the last two frames only what changed of the image noise counts.
  vision_H /= white_share;
  vision_b /= white_share;
  estimate->relative.T_a_b = relativePose(previous, newest);
  estimate->relative.covariance = propagated(J, solveLastTwo(vision_H + rest_H, vision_b + rest_b, 0).covariance);

  estimate->relative.covariance.topLeftCorner<3, 3>() += commonErrors(estimate->relative.T_a_b.translation());

  // From the images alone.
  LastTwo vision = solveLastTwo(vision_H, vision_b, 6);
  vision.step *= newton_gain;
  estimate->vision.T_a_b =
      relativePose(retract(previous, vision.step.head<6>()), retract(newest, vision.step.tail<6>()));
  estimate->vision.covariance = propagated(J, vision.covariance);

  // Scale: from the images and the rotation factors, without velocity and without what is known from before.
  BundleAdjustment rotations;
  rotations.poses = bundle->poses;
  rotations.factors = bundle->factors;
  for (MotionFactor& factor : rotations.factors) factor.translation_information.setZero();
  Eigen::MatrixXd none_H, rotation_H;
  Eigen::VectorXd none_b, rotation_b;
  rotations.linearize(&none_H, &none_b, &rotation_H, &rotation_b, options);
  const LastTwo seen = solveLastTwo(scale_H + rotation_H, rotation_b, 6);
  const Eigen::Matrix3d translation_covariance = propagated(J.topRows<3>(), seen.covariance);
  const double distance = estimate->relative.T_a_b.translation().norm();
  const Eigen::Vector3d direction =
      distance > 0.0 ? Eigen::Vector3d(estimate->relative.T_a_b.translation() / distance) : Eigen::Vector3d::UnitX();
  const double along = direction.dot(translation_covariance * direction);
  // The unseen direction is that of the cameras' motion, which the lever arm sets apart from the body's.
  const Eigen::Vector3d spread = symmetricEigenvalues(translation_covariance);
  const double least = std::sqrt(std::max(0.0, 0.5 * (spread[0] + spread[1])));
  const double most = std::sqrt(std::max(0.0, spread[2]));
  const double noise = most < kEvenlySeen * least ? most : least;
  estimate->scale_sigma =
      distance > 0.0 ? std::sqrt(std::max(0.0, along)) / distance : std::numeric_limits<double>::infinity();
  // Without motion there is no scale. Where the scale is unknown, the noise across the motion decides.
  estimate->scale_state = distance < 3.0 * noise                     ? ScaleState::kNotApplicable
                          : estimate->scale_sigma < kObservableScale ? ScaleState::kObservable
                          : estimate->scale_sigma < kWeakScale       ? ScaleState::kWeak
                                                                     : ScaleState::kUnobservable;
}

bool contradicted(const MotionSummary& prior, const RelativeMotion& vision) {
  const Eigen::Matrix3d& R = prior.T_a_b.linear();
  const Eigen::Vector3d difference = logSO3(vision.T_a_b.linear() * R.transpose());
  const Eigen::Matrix3d covariance =
      propagated(R, prior.rotation_covariance) + vision.covariance.bottomRightCorner<3, 3>();
  return squaredMahalanobis(difference, covariance) > kContradiction * kContradiction;
}

PosePrior marginalizeFirstPose(BundleAdjustment* bundle, const BundleOptions& solve_options) {
  BundleOptions options = solve_options;
  options.inverse_distance_sigma = kUnknownInverseDistance;
  Eigen::MatrixXd vision_H, rest_H;
  Eigen::VectorXd vision_b, rest_b;
  bundle->linearize(&vision_H, &vision_b, &rest_H, &rest_b, options);
  const Eigen::MatrixXd H = vision_H + rest_H;
  const Eigen::VectorXd b = vision_b + rest_b;
  const int rest = static_cast<int>(H.rows()) - 6;
  Matrix6d first = H.topLeftCorner<6, 6>();
  first.diagonal().array() += kWeakestInformation;
  const Eigen::MatrixXd gain = symmetricSolve(first, H.topRightCorner(6, rest));  // first^-1 H_01

  PosePrior prior;
  for (int i = 1; i < static_cast<int>(bundle->poses.size()); ++i) {
    prior.poses.push_back(i);
    prior.linearization.push_back(bundle->poses[i]);
  }
  prior.H = H.bottomRightCorner(rest, rest) - H.bottomLeftCorner(rest, 6) * gain;
  prior.H = 0.5 * (prior.H + prior.H.transpose()).eval();
  prior.b = b.tail(rest) - gain.transpose() * b.head<6>();
  return prior;
}

}  // namespace multicam_egomotion
