// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "multicam_egomotion/estimation/bundle_adjustment.h"

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "multicam_egomotion/geometry/covariance.h"
#include "multicam_egomotion/geometry/so3.h"

namespace multicam_egomotion {
namespace {

using Vector6d = Eigen::Matrix<double, 6, 1>;

// Points stay in front: beyond infinity a reversed translation would explain the images as well [1/m].
constexpr double kSmallestInverseDistance = 1e-4;
constexpr int kMostUnknowns = 3 + 2 * (CameraRig::kMaxCameras - 1);  // of a landmark, offsets included

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

// Where focal length and static errors of the camera move the image [px], and by what each of them moves it.
using ImageErrors = Eigen::Matrix<double, 2, 1 + kFieldTerms>;
ImageErrors imageErrors(const BundleObservation& view) {
  ImageErrors errors;
  errors << view.from_center, view.across * fieldTerms(view.image_position.x(), view.image_position.y()).transpose();
  return errors;
}
// The rows of a pose or a camera against the `Depth` unknowns of a landmark.
template <int kRows, int Depth>
using RowsMatrix = Eigen::Matrix<double, kRows, Depth, kRows == 1 ? Eigen::RowMajor : Eigen::ColMajor, kRows,
                                 Depth == Eigen::Dynamic ? kMostUnknowns : Depth>;
template <int kRows, int Depth>
using Rows = Eigen::Map<RowsMatrix<kRows, Depth>>;

// Calls `work` with the number of rows as a constant, so that products have fixed sizes: of a pose, or of a camera.
template <typename Work>
void withRows(int rows, const Work& work) {
  switch (rows) {
    case 6:
      return work(std::integral_constant<int, 6>());
    case 1:
      return work(std::integral_constant<int, 1>());
    case CameraCorrection::kRotation + 1:
      return work(std::integral_constant<int, CameraCorrection::kRotation + 1>());
    default:
      return work(std::integral_constant<int, CameraCorrection::kAll>());
  }
}

Eigen::Vector2d imageError(const BundleObservation& view, const CameraCorrection& correction) {
  const double across = fieldTerms(view.image_position.x(), view.image_position.y()).dot(correction.field);
  return correction.focal_length * view.from_center + across * view.across;
}

// The point of a landmark seen from the body: direction and distance of one length, whatever the distance.
Eigen::Vector3d fromBody(const BundlePose& pose, const BundleLandmark& landmark) {
  return pose.R.transpose() * (landmark.direction + landmark.inverse_distance * (landmark.origin - pose.p));
}

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

std::array<Eigen::Vector2d, CameraRig::kMaxCameras> BundleLandmark::noOffsets() {
  std::array<Eigen::Vector2d, CameraRig::kMaxCameras> offsets;
  offsets.fill(Eigen::Vector2d::Zero());
  return offsets;
}

Eigen::VectorXd BundlePrior::difference(const std::vector<BundlePose>& all_poses, const BundleCalibration& now) const {
  const int n = static_cast<int>(poses.size());
  Eigen::VectorXd d(6 * n + calibration.size());
  for (int i = 0; i < n; ++i) d.segment<6>(6 * i) = localDifference(linearization[i], all_poses[poses[i]]);
  if (calibration.size() > 0) d.tail(calibration.size()) = calibration.differenceTo(now);
  return d;
}

bool BundleAdjustment::error(const BundleLandmark& landmark, const BundleObservation& observation,
                             Eigen::Vector2d* error_px, Eigen::Vector2d* by_inverse_distance) const {
  const BundlePose& pose = poses[observation.pose];
  const CameraCorrection* correction = calibration.correction(observation.camera);
  Eigen::Vector3d moved = pose.R.transpose() * (landmark.origin - pose.p) - observation.center;
  Eigen::Vector3d x = pose.R.transpose() * landmark.direction + landmark.inverse_distance * moved;
  if (correction) {
    x = correction->R.transpose() * x;
    moved = correction->R.transpose() * moved;
  }
  const double depth = observation.bearing.dot(x);
  if (depth <= 1e-9) return false;
  *error_px = observation.to_pixel * x / depth;
  if (by_inverse_distance) {
    *by_inverse_distance = (observation.to_pixel * moved - *error_px * observation.bearing.dot(moved)) / depth;
  }
  if (correction) *error_px += imageError(observation, *correction);
  *error_px += landmark.offsets[observation.camera];
  return true;
}

double BundleAdjustment::normalizedError(const BundleLandmark& landmark, const BundleObservation& observation) const {
  Eigen::Vector2d error_px;
  return error(landmark, observation, &error_px) ? error_px.norm() / pixel_sigma : -1.0;
}

// Numbers the further cameras of a landmark by their first view; -1 for all others. Answers how many there are.
int BundleAdjustment::furtherCameras(const BundleLandmark& landmark,
                                     std::array<int, CameraRig::kMaxCameras>* offset_of) const {
  offset_of->fill(-1);
  if (offset_sigma <= 0.0) return 0;
  int count = 0;
  for (const BundleObservation& view : landmark.observations) {
    if (view.camera == landmark.observations.front().camera || (*offset_of)[view.camera] >= 0) continue;
    (*offset_of)[view.camera] = count++;
  }
  return count;
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
    if (offset_sigma <= 0.0) continue;
    for (const Eigen::Vector2d& offset : landmark.offsets) {
      sum += 0.5 * offset.squaredNorm() / std::pow(offset_sigma, 2);
    }
  }
  for (const MotionFactor& factor : factors) {
    const BundlePose& a = poses[factor.pose_a];
    const BundlePose& b = poses[factor.pose_b];
    const Eigen::Vector3d r = logSO3(factor.R_a_b.transpose() * a.R.transpose() * b.R);
    const Eigen::Vector3d t = a.R.transpose() * (b.p - a.p) - factor.p_b_a;
    sum += 0.5 * r.dot(factor.rotation_information * r) + 0.5 * t.dot(factor.translation_information * t);
  }
  if (!prior.empty()) {
    const Eigen::VectorXd d = prior.difference(poses, calibration);
    sum += 0.5 * d.dot(prior.H * d) - prior.b.dot(d);
  }
  return sum;
}

// Against landmarks that stay as they are the poses alone are estimated.
void BundleAdjustment::accumulateAgainstFixed(const BundleOptions& options, Eigen::MatrixXd* H, Eigen::VectorXd* b) {
  for (const BundleLandmark& landmark : landmarks) {
    for (const BundleObservation& observation : landmark.observations) {
      const BundlePose& pose = poses[observation.pose];
      const CameraCorrection* correction = calibration.correction(observation.camera);
      const Eigen::Vector3d from_body = fromBody(pose, landmark);
      Eigen::Vector2d error_px;
      if (!error(landmark, observation, &error_px)) continue;
      const Eigen::Vector3d x = from_body - landmark.inverse_distance * observation.center;
      Eigen::Matrix3d C = Eigen::Matrix3d::Identity();
      if (correction) C = correction->R.transpose();
      const double depth = observation.bearing.dot(C * x);
      const Eigen::Vector2d projected = observation.to_pixel * C * x / depth;
      const Eigen::Vector2d residual = error_px / pixel_sigma;
      const double weight = robustWeight(residual.squaredNorm(), options.robust_width);
      const Eigen::Matrix<double, 2, 3> d_x =
          (observation.to_pixel - projected * observation.bearing.transpose()) * C / (pixel_sigma * depth);
      Eigen::Matrix<double, 2, 6> d_pose;
      d_pose.leftCols<3>() = -landmark.inverse_distance * d_x;
      d_pose.rightCols<3>() = d_x * skew(from_body);
      const int row = 6 * observation.pose;
      H->block<6, 6>(row, row).noalias() += weight * d_pose.transpose() * d_pose;
      b->segment<6>(row).noalias() -= weight * d_pose.transpose() * residual;
    }
  }
}

template <int Depth>
void BundleAdjustment::accumulateLandmark(const BundleLandmark& landmark, const int* offset_of, double lambda,
                                          const BundleOptions& options, Eigen::MatrixXd* H, Eigen::VectorXd* b,
                                          LandmarkBlock* block) {
  const int depth = Depth == Eigen::Dynamic ? block->depth : Depth;
  constexpr bool kOffsets = Depth != 3;
  constexpr int kMaxDepth = Depth == Eigen::Dynamic ? kMostUnknowns : Depth;
  using Square = Eigen::Matrix<double, Depth, Depth, Eigen::ColMajor, kMaxDepth, kMaxDepth>;
  using Vector = Eigen::Matrix<double, Depth, 1, Eigen::ColMajor, kMaxDepth, 1>;
  const double inverse_sigma = 1.0 / pixel_sigma;
  const double distance_information = 1.0 / (options.inverse_distance_sigma * options.inverse_distance_sigma);
  const double offset_information = kOffsets ? std::pow(pixel_sigma / offset_sigma, 2) : 0.0;

  Square landmark_H = Square::Zero(depth, depth);
  Vector landmark_b = Vector::Zero(depth);
  landmark_H(2, 2) = distance_information;
  landmark_b(2) = -distance_information * landmark.inverse_distance;
  // The offsets are unknowns in image sigmas.
  if constexpr (kOffsets) {
    for (int camera = 0; camera < CameraRig::kMaxCameras; ++camera) {
      if (offset_of[camera] < 0) continue;
      const int at = 3 + 2 * offset_of[camera];
      landmark_H(at, at) = landmark_H(at + 1, at + 1) = offset_information;
      landmark_b.template segment<2>(at) = -offset_information * inverse_sigma * landmark.offsets[camera];
    }
  }

  const Eigen::Matrix<double, 3, 2> tangent = tangentBasis(landmark.direction);
  const auto segmentOf = [&](int column, int rows) {
    for (int s = block->segment_count - 1; s >= 0; --s) {
      const Segment& known = segments_[block->first_segment + s];
      if (known.column == column) return known.at;
    }
    const int at = static_cast<int>(values_.size());
    values_.resize(at + rows * depth, 0.0);
    segments_.push_back({column, rows, at});
    ++block->segment_count;
    return at;
  };

  for (const BundleObservation& observation : landmark.observations) {
    const BundlePose& pose = poses[observation.pose];
    const CameraCorrection* correction = calibration.correction(observation.camera);
    const Eigen::Vector3d from_body = fromBody(pose, landmark);
    Eigen::Vector3d x = from_body - landmark.inverse_distance * observation.center;
    if (correction) x = correction->R.transpose() * x;
    const double z = observation.bearing.dot(x);
    if (z <= 1e-9) continue;

    const Eigen::Vector2d projected = observation.to_pixel * x * (inverse_sigma / z);
    Eigen::Vector2d residual = projected;
    if (correction) residual += inverse_sigma * imageError(observation, *correction);
    residual += inverse_sigma * landmark.offsets[observation.camera];
    const int offset = offset_of[observation.camera];
    const double square = residual.squaredNorm();
    const double weight = robustWeight(square, options.robust_width);
    weight_sum_ += weight;
    weight_square_sum_ += weight * weight;
    weighted_squares_ += weight * square;

    Eigen::Matrix<double, 2, 3> d_camera = observation.to_pixel * (inverse_sigma / z);  // by x in camera axes
    d_camera -= projected * observation.bearing.transpose() / z;
    const Eigen::Matrix<double, 2, 3> d_x =
        correction ? Eigen::Matrix<double, 2, 3>(d_camera * correction->R.transpose()) : d_camera;
    Eigen::Matrix<double, 2, 6> d_pose;
    d_pose.leftCols<3>() = -landmark.inverse_distance * d_x;
    d_pose.rightCols<3>() = d_x * skew(from_body);
    Eigen::Matrix<double, 2, 3> d_landmark;
    d_landmark.leftCols<2>() = d_x * (pose.R.transpose() * tangent);
    d_landmark.col(2) = d_x * (pose.R.transpose() * (landmark.origin - pose.p) - observation.center);
    const Eigen::Matrix<double, 6, 2> weighted_pose = weight * d_pose.transpose();
    const Eigen::Matrix<double, 3, 2> weighted_landmark = weight * d_landmark.transpose();

    const int row = 6 * observation.pose;
    H->block<6, 6>(row, row).noalias() += weighted_pose * d_pose;
    b->segment<6>(row).noalias() -= weighted_pose * residual;
    landmark_H.template topLeftCorner<3, 3>().noalias() += weighted_landmark * d_landmark;
    landmark_b.template head<3>().noalias() -= weighted_landmark * residual;
    const int at_pose = segmentOf(row, 6);
    Rows<6, Depth> W(values_.data() + at_pose, 6, depth);
    W.template leftCols<3>().noalias() += weighted_pose * d_landmark;
    if constexpr (kOffsets) {
      if (offset >= 0) {
        const int at = 3 + 2 * offset;
        landmark_H.template block<2, 3>(at, 0) += weighted_landmark.transpose();
        landmark_H(at, at) += weight;
        landmark_H(at + 1, at + 1) += weight;
        landmark_b.template segment<2>(at) -= weight * residual;
        W.template middleCols<2>(at) += weighted_pose;
      }
    }
    if (!correction) continue;

    const int column = firstOfCalibration() + correction->column;
    const int rows = correction->parameters();
    const int at_camera = segmentOf(column, rows);
    withRows(rows, [&](auto constant) {
      constexpr int kRows = decltype(constant)::value;
      Eigen::Matrix<double, 2, kRows> d_calibration;
      if constexpr (kRows >= CameraCorrection::kRotation) d_calibration.template leftCols<3>() = d_camera * skew(x);
      if constexpr (kRows == CameraCorrection::kAll) {
        d_calibration.template rightCols<1 + kFieldTerms>() = inverse_sigma * imageErrors(observation);
      } else {
        d_calibration.template rightCols<1>() = inverse_sigma * observation.from_center;
      }
      const Eigen::Matrix<double, kRows, 2> weighted_calibration = weight * d_calibration.transpose();
      H->template block<6, kRows>(row, column) += weighted_pose.lazyProduct(d_calibration);
      H->template block<kRows, kRows>(column, column) += weighted_calibration.lazyProduct(d_calibration);
      b->template segment<kRows>(column) -= weighted_calibration.lazyProduct(residual);
      Rows<kRows, Depth> C(values_.data() + at_camera, kRows, depth);
      C.template leftCols<3>() += weighted_calibration.lazyProduct(d_landmark);
      if constexpr (kOffsets) {
        if (offset >= 0) C.template middleCols<2>(3 + 2 * offset) += weighted_calibration;
      }
    });
  }

  landmark_unknowns_ += 3.0;
  if constexpr (kOffsets) {
    for (int at = 3; at < depth; ++at) landmark_unknowns_ += 1.0 - offset_information / landmark_H(at, at);
    for (int at = 3; at + 1 < depth; at += 2) {
      landmark_H.template block<3, 2>(0, at) = landmark_H.template block<2, 3>(at, 0).transpose();
    }
  }
  landmark_H.diagonal().template head<3>() *= 1.0 + lambda;
  landmark_H.diagonal().template head<2>().array() += 1e-9;
  const Eigen::LLT<Square> llt(landmark_H);
  const Vector y = llt.matrixL().solve(landmark_b);
  block->L = static_cast<int>(values_.size());
  block->y = block->L + depth * depth;
  values_.resize(block->y + depth);
  Eigen::Map<Eigen::Matrix<double, Depth, Depth>>(values_.data() + block->L, depth, depth) = llt.matrixLLT();
  Eigen::Map<Vector>(values_.data() + block->y, depth) = y;

  const Square U_inverse = llt.matrixU().solve(Square::Identity(depth, depth));
  const Segment* segments = segments_.data() + block->first_segment;
  for (int i = 0; i < block->segment_count; ++i) {
    withRows(segments[i].rows, [&](auto rows) {
      constexpr int kRows = decltype(rows)::value;
      Rows<kRows, Depth> W(values_.data() + segments[i].at, kRows, depth);
      W = RowsMatrix<kRows, Depth>(W.lazyProduct(U_inverse));
      b->template segment<kRows>(segments[i].column) -= W.lazyProduct(y);
    });
  }
  for (int i = 0; i < block->segment_count; ++i) {
    withRows(segments[i].rows, [&](auto rows_i) {
      constexpr int kRows = decltype(rows_i)::value;
      const Rows<kRows, Depth> A(values_.data() + segments[i].at, kRows, depth);
      for (int j = 0; j < block->segment_count; ++j) {
        if (segments[j].column < segments[i].column) continue;
        withRows(segments[j].rows, [&](auto rows_j) {
          constexpr int kColumns = decltype(rows_j)::value;
          const Rows<kColumns, Depth> B(values_.data() + segments[j].at, kColumns, depth);
          H->template block<kRows, kColumns>(segments[i].column, segments[j].column) -= A.lazyProduct(B.transpose());
        });
      }
    });
  }
}

void BundleAdjustment::accumulateVision(double lambda, const BundleOptions& options, Eigen::MatrixXd* H,
                                        Eigen::VectorXd* b) {
  H->setZero(size(), size());
  b->setZero(size());
  blocks_.assign(landmarks.size(), LandmarkBlock());
  segments_.clear();
  values_.clear();
  weight_sum_ = weight_square_sum_ = weighted_squares_ = landmark_unknowns_ = 0.0;
  if (options.fix_landmarks) {
    accumulateAgainstFixed(options, H, b);
    return;
  }
  std::array<int, CameraRig::kMaxCameras> offset_of;
  for (std::size_t l = 0; l < landmarks.size(); ++l) {
    LandmarkBlock& block = blocks_[l];
    block.first_segment = static_cast<int>(segments_.size());
    block.depth = 3 + 2 * furtherCameras(landmarks[l], &offset_of);
    if (block.depth == 3) {
      accumulateLandmark<3>(landmarks[l], offset_of.data(), lambda, options, H, b, &block);
    } else if (block.depth == 5) {
      accumulateLandmark<5>(landmarks[l], offset_of.data(), lambda, options, H, b, &block);
    } else {
      accumulateLandmark<Eigen::Dynamic>(landmarks[l], offset_of.data(), lambda, options, H, b, &block);
    }
  }
  H->triangularView<Eigen::StrictlyLower>() = H->transpose();
}

void BundleAdjustment::moveLandmarks(const Eigen::VectorXd& step) {
  std::array<int, CameraRig::kMaxCameras> offset_of;
  for (std::size_t l = 0; l < landmarks.size(); ++l) {
    const LandmarkBlock& block = blocks_[l];
    if (block.segment_count == 0) continue;
    BundleLandmark& landmark = landmarks[l];
    Eigen::VectorXd d = Eigen::Map<const Eigen::VectorXd>(values_.data() + block.y, block.depth);
    for (int s = 0; s < block.segment_count; ++s) {
      const Segment& segment = segments_[block.first_segment + s];
      const Eigen::Map<const Eigen::MatrixXd> A(values_.data() + segment.at, segment.rows, block.depth);
      d.noalias() -= A.transpose() * step.segment(segment.column, segment.rows);
    }
    const Eigen::Map<const Eigen::MatrixXd> L(values_.data() + block.L, block.depth, block.depth);
    L.triangularView<Eigen::Lower>().transpose().solveInPlace(d);
    landmark.direction = (landmark.direction + tangentBasis(landmark.direction) * d.head<2>()).normalized();
    landmark.inverse_distance = std::max(landmark.inverse_distance + d[2], kSmallestInverseDistance);
    if (block.depth == 3) continue;
    furtherCameras(landmark, &offset_of);
    for (int camera = 0; camera < CameraRig::kMaxCameras; ++camera) {
      if (offset_of[camera] >= 0) landmark.offsets[camera] += pixel_sigma * d.segment<2>(3 + 2 * offset_of[camera]);
    }
  }
}

void BundleAdjustment::accumulateRest(Eigen::MatrixXd* H, Eigen::VectorXd* b) const {
  H->setZero(size(), size());
  b->setZero(size());
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
  if (prior.empty()) return;
  const Eigen::VectorXd prior_b = prior.b - prior.H * prior.difference(poses, calibration);
  std::vector<int> columns;
  for (const int pose : prior.poses) {
    for (int i = 0; i < 6; ++i) columns.push_back(6 * pose + i);
  }
  for (int i = 0; i < prior.calibration.size(); ++i) columns.push_back(firstOfCalibration() + i);
  const int n = static_cast<int>(columns.size());
  for (int j = 0; j < n; ++j) {
    (*b)[columns[j]] += prior_b[j];
    for (int i = 0; i < n; ++i) (*H)(columns[i], columns[j]) += prior.H(i, j);
  }
}

void BundleAdjustment::holdConsidered(Eigen::MatrixXd* H, Eigen::VectorXd* b) const {
  for (const int considered : calibration.considered()) {
    const int column = firstOfCalibration() + considered;
    H->col(column).setZero();
    H->row(column).setZero();
    (*H)(column, column) = 1.0;
    (*b)[column] = 0.0;
  }
}

void BundleAdjustment::linearize(Eigen::MatrixXd* vision_H, Eigen::VectorXd* vision_b, Eigen::MatrixXd* rest_H,
                                 Eigen::VectorXd* rest_b, const BundleOptions& options) {
  accumulateVision(0.0, options, vision_H, vision_b);
  accumulateRest(rest_H, rest_b);
}

BundleSummary BundleAdjustment::solve(const BundleOptions& options) {
  BundleSummary summary;
  const int fixed = prior.empty() && !options.fix_landmarks ? 6 : 0;  // the first pose is the gauge
  // Against fixed landmarks the calibration is fixed too.
  const int free = (options.fix_landmarks ? 6 * static_cast<int>(poses.size()) : size()) - fixed;
  Eigen::MatrixXd H(size(), size()), rest_H(size(), size());
  Eigen::VectorXd b(size()), rest_b(size()), step = Eigen::VectorXd::Zero(size());
  double lambda = 1e-5;
  summary.cost = cost(options);

  std::vector<BundlePose> old_poses;
  BundleCalibration old_calibration;
  struct Values {
    Eigen::Vector3d direction;
    double inverse_distance;
    decltype(BundleLandmark::offsets) offsets;
  };
  std::vector<Values> old_landmarks(landmarks.size());
  for (; summary.iterations < options.max_iterations; ++summary.iterations) {
    accumulateVision(lambda, options, &H, &b);
    accumulateRest(&rest_H, &rest_b);
    H += rest_H;
    b += rest_b;
    holdConsidered(&H, &b);
    H.diagonal() *= 1.0 + lambda;
    H.diagonal().array() += 1e-9;
    if (free > 0) step.segment(fixed, free) = symmetricSolve(H.block(fixed, fixed, free, free), b.segment(fixed, free));
    if (!step.allFinite()) {
      summary.finite = false;
      break;
    }

    old_poses = poses;
    old_calibration = calibration;
    for (std::size_t l = 0; l < landmarks.size(); ++l) {
      old_landmarks[l] = {landmarks[l].direction, landmarks[l].inverse_distance, landmarks[l].offsets};
    }
    for (std::size_t i = 0; i < poses.size(); ++i) poses[i] = retract(poses[i], step.segment<6>(6 * i));
    if (calibration.size() > 0) calibration = calibration.retracted(step.tail(calibration.size()));
    moveLandmarks(step);
    const double new_cost = cost(options);
    const double decrease = summary.cost - new_cost;
    if (!(decrease >= 0.0)) {
      poses = old_poses;
      calibration = old_calibration;
      for (std::size_t l = 0; l < landmarks.size(); ++l) {
        landmarks[l].direction = old_landmarks[l].direction;
        landmarks[l].inverse_distance = old_landmarks[l].inverse_distance;
        landmarks[l].offsets = old_landmarks[l].offsets;
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
  summary.degrees_of_freedom = 2.0 * weight_sum_ - (size() - 6.0) - landmark_unknowns_;
  return summary;
}

}  // namespace multicam_egomotion
