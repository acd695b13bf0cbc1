// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

namespace multicam_egomotion {

/// Terms of a static error of the image positions of one camera across the epipolar lines to another: a polynomial of
/// degree 3 of the image position, which holds what is left of the lens. It carries no scale, because the distance of a
/// point moves it along the epipolar lines only. Three terms are left out, because others make them: the constant and
/// the one linear along the lines (rotation), and the one linear across them (focal length).
constexpr int kFieldTerms = 7;
using FieldVector = Eigen::Matrix<double, kFieldTerms, 1>;

/// The terms at a position whose axes run `along` and `across` the epipolar lines, each from -1 to 1 over the image.
FieldVector fieldTerms(double along, double across);

/// Root of the mean square of a field over the image.
double rmsOverImage(const FieldVector& field);

/// What is estimated of one camera beside what the rig file says. Its parameters in this order: the rotation [rad],
/// perturbed R <- R Exp(d), the focal length and the field; a camera has all of them, the first four or the focal
/// length alone.
struct CameraCorrection {
  static constexpr int kRotation = 3, kAll = 4 + kFieldTerms;

  int column = 0;      ///< of its first parameter among those of all cameras
  bool turns = false;  ///< has a rotation
  bool has_field = false;
  int parameters() const { return (turns ? kRotation : 0) + 1 + (has_field ? kFieldTerms : 0); }
  int focalColumn() const { return column + (turns ? kRotation : 0); }

  Eigen::Matrix3d R =
      Eigen::Matrix3d::Identity();          ///< R_body_cam = R * that of the rig file, about the camera's centre
  double focal_length = 0.0;                ///< longer than in the rig file by this share [1]
  FieldVector field = FieldVector::Zero();  ///< [px]
};

/// The calibration in an adjustment. Its parameters are unknowns, or considered: those stay as they are, and their
/// uncertainty is part of that of everything else.
class BundleCalibration {
 public:
  BundleCalibration() = default;
  /// By camera of the rig; columns are assigned here. `estimate`: false to consider all.
  BundleCalibration(std::vector<CameraCorrection> cameras, bool estimate);

  int size() const { return size_; }  ///< parameters of all cameras
  /// Null where the camera has none.
  const CameraCorrection* correction(int camera) const {
    return camera < static_cast<int>(cameras_.size()) ? &cameras_[camera] : nullptr;
  }
  /// What is considered: with `estimate` the focal lengths of cameras without a field, which have nothing to compare
  /// theirs with.
  const std::vector<int>& considered() const { return considered_; }

  /// this ⊞ d.
  BundleCalibration retracted(const Eigen::VectorXd& d) const;
  /// d with this ⊞ d = other.
  Eigen::VectorXd differenceTo(const BundleCalibration& other) const;

 private:
  std::vector<CameraCorrection> cameras_;
  std::vector<int> considered_;
  int size_ = 0;
};

}  // namespace multicam_egomotion
