// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "multicam_egomotion/odometry/rig_calibration.h"

#include <algorithm>
#include <cmath>

namespace multicam_egomotion {
namespace {

constexpr double kExact = 1e-12;     // variance of what the rig file calls exact
constexpr double kFieldSigma = 0.5;  // of each term of a static error across the epipolar lines [px], contract 15

// Of the distance between two cameras, as a share; the first camera's position is exact.
double lengthSigmaOf(const CameraRig& rig, int a, int b) {
  const RigCamera &first = rig.camera(a), &second = rig.camera(b);
  const double distance = (first.T_body_cam.translation() - second.T_body_cam.translation()).norm();
  const double sigma = std::hypot(a == 0 ? 0.0 : first.sigmas.position, second.sigmas.position);
  return distance > sigma ? sigma / distance : 1.0;
}

}  // namespace

RigCalibration::RigCalibration(const CameraRig& rig, bool estimate) : fields_(rig.size()) {
  std::vector<CameraCorrection> corrections(rig.size());
  double overlapping = 1.0, apart = 1.0;  // sigma of the length, the best of the pairs of each kind
  for (int k = 0; k < rig.size(); ++k) {
    const RigCamera& camera = rig.camera(k);
    const std::vector<int>& others = rig.overlappingCameras(k);
    for (int j = 0; j < k; ++j) {
      double& best = std::find(others.begin(), others.end(), j) != others.end() ? overlapping : apart;
      best = std::min(best, lengthSigmaOf(rig, j, k));
    }
    Field& field = fields_[k];
    field.principal_point = {camera.model.cx(), camera.model.cy()};
    corrections[k].turns = k > 0 && camera.sigmas.rotation > 0.0;
    const int reference = others.empty() ? k : *std::min_element(others.begin(), others.end());
    if (!corrections[k].turns || reference > k) continue;
    corrections[k].has_field = field.present = reference < k;
    field.reference = rig.camera(reference).T_body_cam.translation();
    field.half_size = 0.5 * Eigen::Vector2d(camera.model.width(), camera.model.height());
    field.image_center = field.half_size - Eigen::Vector2d::Constant(0.5);
    const Eigen::Vector3d along =
        camera.T_body_cam.linear().transpose() * (field.reference - camera.T_body_cam.translation());
    field.lines_along_y = std::abs(along.y()) > std::abs(along.x());
  }
  if (rig.size() > 1) length_sigma_ = overlapping < 1.0 ? overlapping : apart;

  prior_.calibration = BundleCalibration(corrections, estimate);
  const int size = prior_.calibration.size();
  Eigen::VectorXd variances = Eigen::VectorXd::Constant(size, kFieldSigma * kFieldSigma);
  for (int k = 0; k < rig.size(); ++k) {
    const CameraCorrection& correction = *prior_.calibration.correction(k);
    const CameraSigmas& sigmas = rig.camera(k).sigmas;
    // A shifted principal point looks like a turn.
    const double turn = std::hypot(sigmas.rotation, sigmas.principal_point_px / rig.camera(k).model.focalLength());
    if (correction.turns) variances.segment<3>(correction.column).setConstant(turn * turn);
    double& focal_length = variances[correction.focalColumn()];
    focal_length = std::pow(sigmas.focal_length, 2);
    // Overlapping images show one focal length against the other.
    if (correction.has_field) focal_length += std::pow(rig.camera(0).sigmas.focal_length, 2);
    focal_length = std::max(focal_length, kExact);
  }
  prior_covariance_ = variances.asDiagonal();
  prior_.H = variances.cwiseInverse().asDiagonal();
  prior_.b = Eigen::VectorXd::Zero(size);
  const std::vector<int>& considered = prior_.calibration.considered();
  considered_variances_.resize(static_cast<int>(considered.size()));
  for (std::size_t i = 0; i < considered.size(); ++i) {
    considered_variances_[static_cast<int>(i)] = variances[considered[i]];
    prior_.H(considered[i], considered[i]) = 0.0;
  }
}

void RigCalibration::place(const FeatureObservation& feature, const Eigen::Isometry3d& T_body_cam,
                           BundleObservation* view) const {
  if (feature.camera >= static_cast<int>(fields_.size())) return;
  const Field& field = fields_[feature.camera];
  view->from_center = feature.pixel - field.principal_point;
  if (!field.present) return;
  const Eigen::Vector2d along = feature.to_pixel * (T_body_cam.linear().transpose() * (field.reference - view->center));
  const double length = along.norm();
  if (length <= 1e-9) return;
  view->across = Eigen::Vector2d(-along.y(), along.x()) / length;
  view->image_position = (feature.pixel - field.image_center).cwiseQuotient(field.half_size);
  if (field.lines_along_y) std::swap(view->image_position.x(), view->image_position.y());
}

}  // namespace multicam_egomotion
