// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "multicam_egomotion/odometry/window_marginals.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "multicam_egomotion/geometry/covariance.h"
#include "multicam_egomotion/geometry/so3.h"

namespace multicam_egomotion {
namespace {

constexpr double kObservableScale = 0.1, kWeakScale = 0.5;  // contract 7
constexpr double kWeakestInformation =
    1e-6;  // stands for "unknown" (sigma 1000 m or rad) where a direction is not seen

// What all tracks have in common: error of the direction (mounting of the first camera) [rad].
constexpr double kCommonDirectionError = 2e-4;
constexpr double kEvenlySeen = 5.0;      // ratio of the noise along and across up to which all directions count as seen
constexpr double kContradiction = 10.0;  // sigmas by which the images' rotation differs from a wrong prior
constexpr double kUnknownInverseDistance = 100.0;  // sigma that says nothing of a point's distance [1/m]

using Matrix6x12d = Eigen::Matrix<double, 6, 12>;

Eigen::Matrix3d commonErrors(const Eigen::Vector3d& p, double length_sigma) {
  const double scale = length_sigma * length_sigma, direction = kCommonDirectionError * kCommonDirectionError;
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

// Solution and covariance of the last two poses and of the calibration.
struct Last {
  Eigen::Matrix<double, 12, 1> step = Eigen::Matrix<double, 12, 1>::Zero();
  Eigen::Matrix<double, 12, 12> covariance = Eigen::Matrix<double, 12, 12>::Zero();
  Eigen::MatrixXd calibration;
};

// `hold_previous`: the last but one pose is known, where nothing says where the poses are as a whole. The first would
// leave the others loose where it shares no landmark with them.
Last solveLast(const BundleAdjustment& bundle, Eigen::MatrixXd H, Eigen::VectorXd b, bool hold_previous,
               const Eigen::VectorXd& considered_variances) {
  const std::vector<int>& considered = bundle.calibration.considered();
  const int size = bundle.size(), calibration = bundle.calibration.size(), held = static_cast<int>(considered.size());
  const int poses = bundle.firstOfCalibration(), count = std::min(poses, 12), wanted = count + calibration;
  Eigen::MatrixXd by_considered(size, held);
  for (int i = 0; i < held; ++i) by_considered.col(i) = H.col(poses + considered[i]);
  for (const int column : considered) by_considered.row(poses + column).setZero();
  bundle.holdConsidered(&H, &b);
  const int previous = poses - 12;
  if (hold_previous) {
    H.middleRows<6>(previous).setZero();
    H.middleCols<6>(previous).setZero();
    b.segment<6>(previous).setZero();
    by_considered.middleRows<6>(previous).setZero();
  }
  H.diagonal().array() += kWeakestInformation;

  Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(size, wanted + 1 + held);
  columns.bottomLeftCorner(wanted, wanted).setIdentity();
  columns.col(wanted) = b;
  columns.rightCols(held) = by_considered;
  columns = symmetricSolve(H, columns);
  // What is considered moves the solution by this, and is known no better than before.
  Eigen::MatrixXd moved = columns.bottomRightCorner(wanted, held);
  for (int i = 0; i < held; ++i) moved(count + considered[i], i) = -1.0;
  Eigen::MatrixXd covariance = columns.bottomLeftCorner(wanted, wanted);
  for (const int column : considered) covariance(count + column, count + column) = 0.0;
  if (hold_previous) covariance.topLeftCorner<6, 6>().setZero();
  covariance =
      (0.5 * (covariance + covariance.transpose()) + moved * considered_variances.asDiagonal() * moved.transpose())
          .eval();
  Last result;
  result.covariance.bottomRightCorner(count, count) = covariance.topLeftCorner(count, count);
  result.calibration = covariance.bottomRightCorner(calibration, calibration);
  result.step.tail(count) = columns.col(wanted).tail(wanted).head(count);
  return result;
}

// Information of everything but the first `gone` unknowns, as normal equations.
void eliminateFirst(int gone, Eigen::MatrixXd* H, Eigen::VectorXd* b) {
  const int rest = static_cast<int>(H->rows()) - gone;
  Eigen::MatrixXd first = H->topLeftCorner(gone, gone);
  first.diagonal().array() += kWeakestInformation;
  const Eigen::MatrixXd gain = symmetricSolve(first, H->topRightCorner(gone, rest));  // first^-1 H_01
  const Eigen::MatrixXd left = H->bottomRightCorner(rest, rest) - H->bottomLeftCorner(rest, gone) * gain;
  const Eigen::VectorXd left_b = b->tail(rest) - gain.transpose() * b->head(gone);
  *H = 0.5 * (left + left.transpose());
  *b = left_b;
}

// What the prior says of the calibration alone, as normal equations at the present values.
void addCalibrationPrior(const BundleAdjustment& bundle, Eigen::MatrixXd* H, Eigen::VectorXd* b) {
  const int size = bundle.calibration.size();
  if (size == 0) return;
  Eigen::MatrixXd prior_H = bundle.prior.H;
  Eigen::VectorXd prior_b = bundle.prior.b - prior_H * bundle.prior.difference(bundle.poses, bundle.calibration);
  eliminateFirst(6 * static_cast<int>(bundle.prior.poses.size()), &prior_H, &prior_b);
  H->bottomRightCorner(size, size) += prior_H;
  b->tail(size) += prior_b;
}

}  // namespace

void computeMarginals(BundleAdjustment* bundle, const BundleOptions& solve_options, double white_share,
                      double length_sigma, const Eigen::VectorXd& considered_variances, WindowEstimate* estimate) {
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
  const Last all = solveLast(*bundle, vision_H + rest_H, vision_b + rest_b, false, considered_variances);
  estimate->calibration_covariance = all.calibration;
  Matrix6d to_odom = Matrix6d::Zero();
  to_odom.topLeftCorner<3, 3>() = to_odom.bottomRightCorner<3, 3>() = newest.R;
  estimate->covariance = propagated(to_odom, all.covariance.bottomRightCorner<6, 6>());

  const Eigen::MatrixXd scale_H = vision_H;

  // Between the last two frames only what changed of the image noise counts.
  vision_H /= white_share;
  vision_b /= white_share;
  estimate->relative.T_a_b = relativePose(previous, newest);
  estimate->relative.covariance =
      propagated(J, solveLast(*bundle, vision_H + rest_H, vision_b + rest_b, false, considered_variances).covariance);

  estimate->relative.covariance.topLeftCorner<3, 3>() +=
      commonErrors(estimate->relative.T_a_b.translation(), length_sigma);

  // From the images alone.
  addCalibrationPrior(*bundle, &vision_H, &vision_b);
  Last vision = solveLast(*bundle, vision_H, vision_b, true, considered_variances);
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
  Eigen::MatrixXd seen_H = scale_H;
  const int poses = 6 * n;
  seen_H.topLeftCorner(poses, poses) += rotation_H;
  Eigen::VectorXd seen_b = Eigen::VectorXd::Zero(seen_H.rows());
  addCalibrationPrior(*bundle, &seen_H, &seen_b);
  const Last seen = solveLast(*bundle, seen_H, seen_b, true, considered_variances);
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
  estimate->scale_noise =
      distance > 0.0 ? std::sqrt(std::max(0.0, along)) / distance : std::numeric_limits<double>::infinity();
  estimate->scale_sigma = std::hypot(estimate->scale_noise, length_sigma);
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

BundlePrior marginalizeFirstPoses(int count, BundleAdjustment* bundle, const BundleOptions& solve_options) {
  BundleOptions options = solve_options;
  options.inverse_distance_sigma = kUnknownInverseDistance;
  Eigen::MatrixXd vision_H, rest_H;
  Eigen::VectorXd vision_b, rest_b;
  bundle->linearize(&vision_H, &vision_b, &rest_H, &rest_b, options);
  BundlePrior prior;
  prior.H = vision_H + rest_H;
  prior.b = vision_b + rest_b;
  eliminateFirst(6 * count, &prior.H, &prior.b);
  // What is considered is not learnt: only how it moves the others is kept.
  for (const int i : bundle->calibration.considered()) {
    const int column = static_cast<int>(prior.b.size()) - bundle->calibration.size() + i;
    prior.H(column, column) = 0.0;
    prior.b[column] = 0.0;
  }
  for (int i = count; i < static_cast<int>(bundle->poses.size()); ++i) {
    prior.poses.push_back(i);
    prior.linearization.push_back(bundle->poses[i]);
  }
  prior.calibration = bundle->calibration;
  return prior;
}

}  // namespace multicam_egomotion
