// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "multicam_egomotion/estimation/bundle_adjustment.h"
#include "multicam_egomotion/geometry/camera_rig.h"
#include "multicam_egomotion/tracking/tracked_frame.h"

namespace multicam_egomotion {

/// What the window estimates of a rig's calibration, and how well the rig file knows it. The first camera is the
/// reference: it is where the rig file places it. Of each further camera the rotation is estimated, and where it
/// overlaps with one before it a static error across the epipolar lines as well. Distances between cameras and focal
/// lengths are not estimated: the images cannot tell them from another scale. They make the uncertainty of the length.
class RigCalibration {
 public:
  /// Nothing is estimated and everything is exact.
  RigCalibration() = default;
  /// `estimate`: false to take rotations and lenses as the rig file says.
  RigCalibration(const CameraRig& rig, bool estimate);

  /// As the rig file knows it, about its own values.
  const BundlePrior& prior() const { return prior_; }
  /// Its covariance, in the order of the parameters [rad, 1, px].
  const Eigen::MatrixXd& priorCovariance() const { return prior_covariance_; }
  const Eigen::VectorXd& consideredVariances() const { return considered_variances_; }
  /// Of all lengths, by the distances between the cameras [1].
  double lengthSigma() const { return length_sigma_; }

  /// Fills in what the field of the camera needs to know of a view whose centre is set.
  void place(const FeatureObservation& feature, const Eigen::Isometry3d& T_body_cam, BundleObservation* view) const;

 private:
  struct Field {
    bool present = false;
    Eigen::Vector3d reference;                                 // centre of the other camera, body axes [m]
    Eigen::Vector2d principal_point, image_center, half_size;  // [px]
    bool lines_along_y = false;                                // the epipolar lines run rather along the image's y axis
  };

  BundlePrior prior_;
  Eigen::MatrixXd prior_covariance_;
  Eigen::VectorXd considered_variances_;
  double length_sigma_ = 0.0;
  std::vector<Field> fields_;  // by camera
};

}  // namespace multicam_egomotion
