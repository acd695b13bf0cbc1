// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "multicam_egomotion/estimation/bundle_adjustment.h"

#include <algorithm>
#include <cmath>

#include "multicam_egomotion/geometry/covariance.h"
#include "multicam_egomotion/geometry/so3.h"

namespace multicam_egomotion {
namespace {

using Vector6d = Eigen::Matrix<double, 6, 1>;

// Points stay in front: beyond infinity a reversed translation would explain the images as well [1/m].
constexpr double kSmallestInverseDistance = 1e-4;

// Two unit vectors that complete `direction` to an orthogonal frame.
Eigen::Matrix<double, 3, 2> tangentBasis(const Eigen::Vector3d& direction) {
  Eigen::Vector3d other = Eigen::Vector3d::Zero();
  int smallest;
  direction.cwiseAbs().minCoeff(&smallest);
  other[smallest] = 1.0;
  Eigen::Matrix<double, 3, 2> basis;
  basis.col(0) = direction.cross(other).normalized();
  basis.col(1) = direction.cross(basis.col(0));
  return basis;
}

// Cauchy loss of a squared normalized error and its weight.
double robustCost(double square, double width) {
  const double w2 = width * width;
  return 0.5 * w2 * std::log1p(square / w2);
}
double robustWeight(double square, double width) { return 1.0 / (1.0 + square / (width * width)); }

}  // namespace

Vector6d localDifference(const BundlePose& a, const BundlePose& b) {
  Vector6d d;
  d.head<3>() = a.R.transpose() * (b.p - a.p);
  d.tail<3>() = logSO3(a.R.transpose() * b.R);
  return d;
}

BundlePose retract(const BundlePose& a, const Vector6d& d) {
  BundlePose result;
  result.p = a.p + a.R * d.head<3>();
  result.R = Eigen::Quaterniond(a.R * expSO3(d.tail<3>())).normalized().toRotationMatrix();
  return result;
}

bool BundleAdjustment::error(const BundleLandmark& landmark, const BundleObservation& observation,
                             Eigen::Vector2d* error_px, Eigen::Vector2d* by_inverse_distance) const {
  const BundlePose& pose = poses[observation.pose];
  const Eigen::Vector3d moved = pose.R.transpose() * (landmark.origin - pose.p) - observation.center;
  const Eigen::Vector3d x = pose.R.transpose() * landmark.direction + landmark.inverse_distance * moved;
  const double depth = observation.bearing.dot(x);
  if (depth <= 1e-9) return false;
  *error_px = observation.to_pixel * x / depth;
  if (by_inverse_distance) {
    *by_inverse_distance = (observation.to_pixel * moved - *error_px * observation.bearing.dot(moved)) / depth;
  }
  return true;
}

double BundleAdjustment::normalizedError(const BundleLandmark& landmark, const BundleObservation& observation) const {
  Eigen::Vector2d error_px;
  return error(landmark, observation, &error_px) ? error_px.norm() / pixel_sigma : -1.0;
}

double BundleAdjustment::cost(const BundleOptions& options) const {
  double sum = 0.0;
  for (const BundleLandmark& landmark : landmarks) {
    const double distance_error = landmark.inverse_distance / options.inverse_distance_sigma;
    sum += 0.5 * distance_error * distance_error;
    for (const BundleObservation& observation : landmark.observations) {
      const double error = normalizedError(landmark, observation);
      sum += robustCost(error < 0.0 ? 1e6 : error * error, options.robust_width);
    }
  }
  for (const MotionFactor& factor : factors) {
    const BundlePose& a = poses[factor.pose_a];
    const BundlePose& b = poses[factor.pose_b];
    const Eigen::Vector3d r = logSO3(factor.R_a_b.transpose() * a.R.transpose() * b.R);
    const Eigen::Vector3d t = a.R.transpose() * (b.p - a.p) - factor.p_b_a;
    sum += 0.5 * r.dot(factor.rotation_information * r) + 0.5 * t.dot(factor.translation_information * t);
  }
  if (!prior.poses.empty()) {
    Eigen::VectorXd d(prior.b.size());
    for (std::size_t i = 0; i < prior.poses.size(); ++i) {
      d.segment<6>(6 * i) = localDifference(prior.linearization[i], poses[prior.poses[i]]);
    }
    sum += 0.5 * d.dot(prior.H * d) - prior.b.dot(d);
  }
  return sum;
}

void BundleAdjustment::accumulateVision(double lambda, const BundleOptions& options, const std::vector<char>* use,
                                        Eigen::MatrixXd* H, Eigen::VectorXd* b) {
  const int size = 6 * static_cast<int>(poses.size());
  H->setZero(size, size);
  b->setZero(size);
  blocks_.resize(landmarks.size());
  couplings_.clear();
  weight_sum_ = weight_square_sum_ = weighted_squares_ = 0.0;
  const double inverse_sigma = 1.0 / pixel_sigma;
  const double distance_information = 1.0 / (options.inverse_distance_sigma * options.inverse_distance_sigma);

  for (std::size_t l = 0; l < landmarks.size(); ++l) {
    const BundleLandmark& landmark = landmarks[l];
    LandmarkBlock& block = blocks_[l];
    block.first_coupling = static_cast<int>(couplings_.size());
    block.coupling_count = 0;
    if (use && !(*use)[l]) continue;

    const Eigen::Matrix<double, 3, 2> tangent = tangentBasis(landmark.direction);
    Eigen::Matrix3d landmark_H = Eigen::Matrix3d::Zero();
    Eigen::Vector3d landmark_b = Eigen::Vector3d::Zero();
    landmark_H(2, 2) = distance_information;
    landmark_b(2) = -distance_information * landmark.inverse_distance;

    for (const BundleObservation& observation : landmark.observations) {
      const BundlePose& pose = poses[observation.pose];
      const Eigen::Vector3d from_body =
          pose.R.transpose() * (landmark.direction + landmark.inverse_distance * (landmark.origin - pose.p));
      const Eigen::Vector3d x = from_body - landmark.inverse_distance * observation.center;
      const double depth = observation.bearing.dot(x);
      if (depth <= 1e-9) continue;

      const Eigen::Vector2d residual = observation.to_pixel * x * (inverse_sigma / depth);
      const double square = residual.squaredNorm();
      const double weight = robustWeight(square, options.robust_width);
      weight_sum_ += weight;
      weight_square_sum_ += weight * weight;
      weighted_squares_ += weight * square;

      Eigen::Matrix<double, 2, 3> d_x = observation.to_pixel * (inverse_sigma / depth);
      d_x -= residual * observation.bearing.transpose() / depth;
      Eigen::Matrix<double, 2, 6> d_pose;
      d_pose.leftCols<3>() = -landmark.inverse_distance * d_x;
      d_pose.rightCols<3>() = d_x * skew(from_body);
      const int row = 6 * observation.pose;
      H->block<6, 6>(row, row).noalias() += weight * d_pose.transpose() * d_pose;
      b->segment<6>(row).noalias() -= weight * d_pose.transpose() * residual;
      if (options.fix_landmarks) continue;

      Eigen::Matrix<double, 2, 3> d_landmark;
      d_landmark.leftCols<2>() = d_x * (pose.R.transpose() * tangent);
      d_landmark.col(2) = d_x * (pose.R.transpose() * (landmark.origin - pose.p) - observation.center);
      landmark_H.noalias() += weight * d_landmark.transpose() * d_landmark;
      landmark_b.noalias() -= weight * d_landmark.transpose() * residual;

      Coupling* coupling = nullptr;
      for (int c = 0; c < block.coupling_count; ++c) {
        Coupling& candidate = couplings_[block.first_coupling + c];
        if (candidate.pose == observation.pose) coupling = &candidate;
      }
      if (!coupling) {
        couplings_.push_back({observation.pose, Eigen::Matrix<double, 6, 3>::Zero()});
        coupling = &couplings_.back();
        ++block.coupling_count;
      }
      coupling->W.noalias() += weight * d_pose.transpose() * d_landmark;
    }

    landmark_H.diagonal() *= 1.0 + lambda;
    landmark_H.diagonal().head<2>().array() += 1e-9;
    block.H_inverse = landmark_H.inverse();
    block.b = landmark_b;
    for (int i = 0; i < block.coupling_count; ++i) {
      const Coupling& a = couplings_[block.first_coupling + i];
      const Eigen::Matrix<double, 6, 3> a_inverse = a.W * block.H_inverse;
      b->segment<6>(6 * a.pose).noalias() -= a_inverse * landmark_b;
      for (int j = 0; j < block.coupling_count; ++j) {
        const Coupling& c = couplings_[block.first_coupling + j];
        if (c.pose < a.pose) continue;
        H->block<6, 6>(6 * a.pose, 6 * c.pose).noalias() -= a_inverse * c.W.transpose();
      }
    }
  }
  H->triangularView<Eigen::StrictlyLower>() = H->transpose();
}

void BundleAdjustment::accumulateRest(Eigen::MatrixXd* H, Eigen::VectorXd* b) const {
  const int size = 6 * static_cast<int>(poses.size());
  H->setZero(size, size);
  b->setZero(size);
  for (const MotionFactor& factor : factors) {
    const BundlePose& pa = poses[factor.pose_a];
    const BundlePose& pb = poses[factor.pose_b];
    const int ia = 6 * factor.pose_a, ib = 6 * factor.pose_b;
    const Eigen::Matrix3d R_a_b = pa.R.transpose() * pb.R;

    Eigen::Matrix<double, 6, 12> J = Eigen::Matrix<double, 6, 12>::Zero();  // (translation, rotation) by (a, b)
    Eigen::Matrix<double, 6, 1> r;
    r.head<3>() = pa.R.transpose() * (pb.p - pa.p) - factor.p_b_a;
    r.tail<3>() = logSO3(factor.R_a_b.transpose() * R_a_b);
    J.block<3, 3>(0, 0) = -Eigen::Matrix3d::Identity();
    J.block<3, 3>(0, 3) = skew(pa.R.transpose() * (pb.p - pa.p));
    J.block<3, 3>(0, 6) = R_a_b;
    const Eigen::Matrix3d inverse_jacobian = inverseRightJacobianSO3(r.tail<3>());
    J.block<3, 3>(3, 3) = -inverse_jacobian * R_a_b.transpose();
    J.block<3, 3>(3, 9) = inverse_jacobian;

    Eigen::Matrix<double, 6, 6> information = Eigen::Matrix<double, 6, 6>::Zero();
    information.topLeftCorner<3, 3>() = factor.translation_information;
    information.bottomRightCorner<3, 3>() = factor.rotation_information;
    const Eigen::Matrix<double, 12, 12> JtJ = propagated(J.transpose(), information);
    const Eigen::Matrix<double, 12, 1> Jtr = -J.transpose() * information * r;
    H->block<6, 6>(ia, ia) += JtJ.block<6, 6>(0, 0);
    H->block<6, 6>(ia, ib) += JtJ.block<6, 6>(0, 6);
    H->block<6, 6>(ib, ia) += JtJ.block<6, 6>(6, 0);
    H->block<6, 6>(ib, ib) += JtJ.block<6, 6>(6, 6);
    b->segment<6>(ia) += Jtr.head<6>();
    b->segment<6>(ib) += Jtr.tail<6>();
  }
  const int n = static_cast<int>(prior.poses.size());
  if (n == 0) return;
  Eigen::VectorXd d(6 * n);
  for (int i = 0; i < n; ++i) {
    d.segment<6>(6 * i) = localDifference(prior.linearization[i], poses[prior.poses[i]]);
  }
  const Eigen::VectorXd prior_b = prior.b - prior.H * d;
  for (int i = 0; i < n; ++i) {
    b->segment<6>(6 * prior.poses[i]) += prior_b.segment<6>(6 * i);
    for (int j = 0; j < n; ++j) {
      H->block<6, 6>(6 * prior.poses[i], 6 * prior.poses[j]) += prior.H.block<6, 6>(6 * i, 6 * j);
    }
  }
}

void BundleAdjustment::linearize(Eigen::MatrixXd* vision_H, Eigen::VectorXd* vision_b, Eigen::MatrixXd* rest_H,
                                 Eigen::VectorXd* rest_b, const BundleOptions& options, const std::vector<char>* use) {
  accumulateVision(0.0, options, use, vision_H, vision_b);
  accumulateRest(rest_H, rest_b);
}

BundleSummary BundleAdjustment::solve(const BundleOptions& options) {
  BundleSummary summary;
  const int size = 6 * static_cast<int>(poses.size());
  const int fixed = prior.poses.empty() && !options.fix_landmarks ? 6 : 0;  // the first pose is the gauge
  Eigen::MatrixXd H(size, size), rest_H(size, size);
  Eigen::VectorXd b(size), rest_b(size), step(size);
  double lambda = 1e-5;
  summary.cost = cost(options);

  std::vector<BundlePose> old_poses;
  std::vector<std::pair<Eigen::Vector3d, double>> old_landmarks(landmarks.size());
  for (; summary.iterations < options.max_iterations; ++summary.iterations) {
    accumulateVision(lambda, options, nullptr, &H, &b);
    accumulateRest(&rest_H, &rest_b);
    H += rest_H;
    b += rest_b;
    H.diagonal() *= 1.0 + lambda;
    H.diagonal().array() += 1e-9;
    step.setZero();
    if (size > fixed) {
      step.tail(size - fixed) = symmetricSolve(H.bottomRightCorner(size - fixed, size - fixed), b.tail(size - fixed));
    }
    if (!step.allFinite()) {
      summary.finite = false;
      break;
    }

    old_poses = poses;
    for (std::size_t i = 0; i < poses.size(); ++i) poses[i] = retract(poses[i], step.segment<6>(6 * i));
    for (std::size_t l = 0; l < landmarks.size(); ++l) {
      BundleLandmark& landmark = landmarks[l];
      old_landmarks[l] = {landmark.direction, landmark.inverse_distance};
      const LandmarkBlock& block = blocks_[l];
      if (block.coupling_count == 0) continue;
      Eigen::Vector3d rhs = block.b;
      for (int c = 0; c < block.coupling_count; ++c) {
        const Coupling& coupling = couplings_[block.first_coupling + c];
        rhs.noalias() -= coupling.W.transpose() * step.segment<6>(6 * coupling.pose);
      }
      const Eigen::Vector3d d = block.H_inverse * rhs;
      landmark.direction = (landmark.direction + tangentBasis(landmark.direction) * d.head<2>()).normalized();
      landmark.inverse_distance = std::max(landmark.inverse_distance + d[2], kSmallestInverseDistance);
    }
    const double new_cost = cost(options);
    const double decrease = summary.cost - new_cost;
    if (!(decrease >= 0.0)) {
      poses = old_poses;
      for (std::size_t l = 0; l < landmarks.size(); ++l) {
        landmarks[l].direction = old_landmarks[l].first;
        landmarks[l].inverse_distance = old_landmarks[l].second;
      }
      lambda = std::max(lambda, 1e-4) * 10.0;
      continue;
    }
    const double previous = summary.cost;
    summary.cost = new_cost;
    lambda *= 0.1;
    if (decrease < options.relative_decrease * std::abs(previous)) {
      ++summary.iterations;
      break;
    }
  }
  summary.weighted_square_sum = weighted_squares_;
  double unknowns = size - 6.0;
  for (const LandmarkBlock& block : blocks_) unknowns += block.coupling_count > 0 ? 3.0 : 0.0;
  summary.degrees_of_freedom = 2.0 * weight_sum_ - unknowns;
  return summary;
}

}  // namespace multicam_egomotion
