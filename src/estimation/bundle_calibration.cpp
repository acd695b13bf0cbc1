// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "multicam_egomotion/estimation/bundle_calibration.h"

#include <Eigen/Geometry>
#include <cmath>
#include <utility>

#include "multicam_egomotion/geometry/so3.h"

namespace multicam_egomotion {

FieldVector fieldTerms(double along, double across) {
  const double s = along, t = across;
  FieldVector terms;
  terms << s * s, s * t, t * t, s * s * s, s * s * t, s * t * t, t * t * t;
  return terms;
}

double rmsOverImage(const FieldVector& field) {
  constexpr int kSteps = 16;
  double sum = 0.0;
  for (int i = 0; i < kSteps; ++i) {
    for (int j = 0; j < kSteps; ++j) {
      const double along = (2.0 * i + 1.0) / kSteps - 1.0, across = (2.0 * j + 1.0) / kSteps - 1.0;
      sum += std::pow(fieldTerms(along, across).dot(field), 2);
    }
  }
  return std::sqrt(sum) / kSteps;
}

BundleCalibration::BundleCalibration(std::vector<CameraCorrection> cameras, bool estimate)
    : cameras_(std::move(cameras)) {
  for (CameraCorrection& camera : cameras_) {
    camera.column = size_;
    size_ += camera.parameters();
    if (estimate && !camera.has_field) considered_.push_back(camera.focalColumn());
    for (int i = camera.column; !estimate && i < size_; ++i) considered_.push_back(i);
  }
}

BundleCalibration BundleCalibration::retracted(const Eigen::VectorXd& d) const {
  BundleCalibration result = *this;
  for (CameraCorrection& camera : result.cameras_) {
    if (camera.turns) {
      camera.R = Eigen::Quaterniond(camera.R * expSO3(d.segment<3>(camera.column))).normalized().toRotationMatrix();
    }
    camera.focal_length += d[camera.focalColumn()];
    if (camera.has_field) camera.field += d.segment<kFieldTerms>(camera.focalColumn() + 1);
  }
  return result;
}

Eigen::VectorXd BundleCalibration::differenceTo(const BundleCalibration& other) const {
  Eigen::VectorXd d(size_);
  for (std::size_t i = 0; i < cameras_.size(); ++i) {
    const CameraCorrection &a = cameras_[i], &b = other.cameras_[i];
    if (a.turns) d.segment<3>(a.column) = logSO3(a.R.transpose() * b.R);
    d[a.focalColumn()] = b.focal_length - a.focal_length;
    if (a.has_field) d.segment<kFieldTerms>(a.focalColumn() + 1) = b.field - a.field;
  }
  return d;
}

}  // namespace multicam_egomotion
