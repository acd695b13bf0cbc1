// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "multicam_egomotion/geometry/camera_rig.h"

namespace multicam_egomotion {

/// Where in the images of a rig features may be.
class FeatureRegions {
 public:
  /// `rig` must outlive this; `border_px`: left free along the edges of the images [px].
  FeatureRegions(const CameraRig& rig, double border_px) : rig_(rig), border_px_(border_px), masks_(rig.size()) {}

  /// As FeatureTracker::setMask.
  void setMask(int camera, const cv::Mat& mask);
  /// CV_8UC1 of the camera's size, 0 = ignore; empty: none.
  const cv::Mat& mask(int camera) const { return masks_[camera]; }

  /// Whether a feature of a camera may be at `pixel` [px].
  bool contain(int camera, const Eigen::Vector2d& pixel) const;

 private:
  const CameraRig& rig_;
  double border_px_;
  std::vector<cv::Mat> masks_;
};

}  // namespace multicam_egomotion
