// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "multicam_egomotion/tracking/feature_regions.h"

#include <stdexcept>
#include <string>

namespace multicam_egomotion {

void FeatureRegions::setMask(int camera, const cv::Mat& mask) {
  if (camera < 0 || camera >= rig_.size()) {
    throw std::invalid_argument("mask camera: found " + std::to_string(camera) + ", expected a camera of the rig");
  }
  const CameraModel& model = rig_.camera(camera).model;
  if (!mask.empty() && (mask.type() != CV_8UC1 || mask.cols != model.width() || mask.rows != model.height())) {
    throw std::invalid_argument("mask of camera " + std::to_string(camera) + ": found " + std::to_string(mask.cols) +
                                "x" + std::to_string(mask.rows) + " of OpenCV type " + std::to_string(mask.type()) +
                                ", expected " + std::to_string(model.width()) + "x" + std::to_string(model.height()) +
                                " of CV_8UC1");
  }
  masks_[camera] = mask.clone();
}

bool FeatureRegions::contain(int camera, const Eigen::Vector2d& pixel) const {
  if (!rig_.camera(camera).model.contains(pixel, border_px_)) return false;
  const cv::Mat& mask = masks_[camera];
  return mask.empty() || mask.at<uchar>(cvRound(pixel.y()), cvRound(pixel.x())) != 0;
}

}  // namespace multicam_egomotion
