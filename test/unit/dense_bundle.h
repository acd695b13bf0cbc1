// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <vector>

#include "bundle_scene.h"
#include "multicam_egomotion/geometry/covariance.h"

namespace multicam_egomotion {

/// Landmark moved by (two angles, inverse distance).
inline BundleLandmark moved(const BundleLandmark& landmark, const Eigen::Vector3d& d) {
  BundleLandmark result = landmark;
  const Eigen::Vector3d u = landmark.direction.unitOrthogonal(), v = landmark.direction.cross(u);
  result.direction = (landmark.direction + d[0] * u + d[1] * v).normalized();
  result.inverse_distance += d[2];
  return result;
}

/// All unknowns of a bundle adjustment in a row: the poses, the calibration, and landmark by landmark the direction
/// (two), the inverse distance and the offset of each further camera.
class DenseBundle {
 public:
  explicit DenseBundle(const BundleAdjustment& bundle) : kept_(bundle.size()), size_(kept_) {
    for (const BundleLandmark& landmark : bundle.landmarks) {
      first_.push_back(size_);
      std::vector<int> further;
      for (const BundleObservation& view : landmark.observations) {
        const bool known = std::find(further.begin(), further.end(), view.camera) != further.end();
        if (view.camera != landmark.observations.front().camera && !known) further.push_back(view.camera);
      }
      if (bundle.offset_sigma <= 0.0) further.clear();
      size_ += 3 + 2 * static_cast<int>(further.size());
      further_.push_back(further);
    }
  }

  int size() const { return size_; }
  /// Poses and calibration.
  int kept() const { return kept_; }
  int firstOf(int landmark) const { return first_[landmark]; }
  int unknownsOf(int landmark) const { return 3 + 2 * static_cast<int>(further_[landmark].size()); }
  const std::vector<int>& furtherCameras(int landmark) const { return further_[landmark]; }

  /// The bundle with its unknowns moved by d, in any part of them from `first` on.
  BundleAdjustment retracted(const BundleAdjustment& bundle, int first, const Eigen::VectorXd& part) const {
    Eigen::VectorXd d = Eigen::VectorXd::Zero(size_);
    d.segment(first, part.size()) = part;
    BundleAdjustment result = bundle;
    for (std::size_t i = 0; i < bundle.poses.size(); ++i) {
      result.poses[i] = retract(bundle.poses[i], d.segment<6>(6 * i));
    }
    if (bundle.calibration.size() > 0) {
      result.calibration =
          bundle.calibration.retracted(d.segment(bundle.firstOfCalibration(), bundle.calibration.size()));
    }
    for (std::size_t l = 0; l < first_.size(); ++l) {
      result.landmarks[l] = moved(bundle.landmarks[l], d.segment<3>(first_[l]));
      for (std::size_t i = 0; i < further_[l].size(); ++i) {
        result.landmarks[l].offsets[further_[l][i]] += d.segment<2>(first_[l] + 3 + 2 * i);
      }
    }
    return result;
  }

  /// Normal equations of the observations, by central differences.
  void linearize(const BundleAdjustment& bundle, const BundleOptions& options, Eigen::MatrixXd* H,
                 Eigen::VectorXd* b) const {
    const Eigen::VectorXd plain = residualsOf(bundle);
    Eigen::VectorXd root_weights(plain.size());
    for (int i = 0; i < plain.size(); i += 2) {
      const double square = plain.segment<2>(i).squaredNorm() / (options.robust_width * options.robust_width);
      root_weights.segment<2>(i).setConstant(1.0 / std::sqrt(1.0 + square));
    }
    const double step = 1e-5;
    Eigen::MatrixXd J(plain.size(), size_);
    for (int c = 0; c < size_; ++c) {
      const Eigen::VectorXd d = Eigen::VectorXd::Constant(1, step);
      const Eigen::VectorXd change = residualsOf(retracted(bundle, c, d)) - residualsOf(retracted(bundle, c, -d));
      J.col(c) = root_weights.cwiseProduct(change) / (2.0 * step);
    }
    *H = J.transpose() * J;
    *b = -J.transpose() * root_weights.cwiseProduct(plain);
    const auto addPrior = [&](int at, double value, double sigma) {
      (*H)(at, at) += 1.0 / (sigma * sigma);
      (*b)[at] -= value / (sigma * sigma);
    };
    for (std::size_t l = 0; l < first_.size(); ++l) {
      addPrior(first_[l] + 2, bundle.landmarks[l].inverse_distance, options.inverse_distance_sigma);
      for (std::size_t i = 0; i < further_[l].size(); ++i) {
        const Eigen::Vector2d& offset = bundle.landmarks[l].offsets[further_[l][i]];
        for (int axis : {0, 1}) addPrior(first_[l] + 3 + 2 * i + axis, offset[axis], bundle.offset_sigma);
      }
    }
  }

 private:
  static Eigen::VectorXd residualsOf(const BundleAdjustment& bundle) {
    std::vector<double> residuals;
    for (const BundleLandmark& landmark : bundle.landmarks) {
      for (const BundleObservation& view : landmark.observations) {
        const Eigen::Vector2d error = errorOf(bundle, landmark, view) / bundle.pixel_sigma;
        residuals.push_back(error.x());
        residuals.push_back(error.y());
      }
    }
    return Eigen::Map<Eigen::VectorXd>(residuals.data(), static_cast<int>(residuals.size()));
  }

  int kept_, size_;
  std::vector<int> first_;                 // by landmark
  std::vector<std::vector<int>> further_;  // cameras, by landmark
};

/// Schur complement of all but the first `kept` unknowns.
inline void eliminateLast(const Eigen::MatrixXd& H, const Eigen::VectorXd& b, int kept, Eigen::MatrixXd* reduced_H,
                          Eigen::VectorXd* reduced_b) {
  const int gone = static_cast<int>(H.rows()) - kept;
  const Eigen::MatrixXd gain = symmetricSolve(H.bottomRightCorner(gone, gone), H.bottomLeftCorner(gone, kept));
  *reduced_H = H.topLeftCorner(kept, kept) - H.topRightCorner(kept, gone) * gain;
  *reduced_b = b.head(kept) - gain.transpose() * b.tail(gone);
}

}  // namespace multicam_egomotion
