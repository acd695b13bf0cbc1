// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "multicam_egomotion/ros/feature_image.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>

namespace multicam_egomotion {

cv::Mat drawFeatures(const EgoMotionResult& result, const CameraRig& rig, const RecentImages& images) {
  constexpr int kColumns = 2, kSubpixelBits = 4;
  cv::Size cell(0, 0);
  for (const RigCamera& camera : rig.cameras()) {
    cell.width = std::max(cell.width, camera.model.width());
    cell.height = std::max(cell.height, camera.model.height());
  }
  const int rows = (rig.size() + kColumns - 1) / kColumns;
  cv::Mat canvas = cv::Mat::zeros(rows * cell.height, std::min(rig.size(), kColumns) * cell.width, CV_8UC3);

  std::vector<cv::Mat> views;
  for (int i = 0; i < rig.size(); ++i) {
    const CameraModel& model = rig.camera(i).model;
    views.push_back(
        canvas(cv::Rect((i % kColumns) * cell.width, (i / kColumns) * cell.height, model.width(), model.height())));
    const bool present = i < static_cast<int>(result.image_stamps_ns.size()) && result.image_stamps_ns[i] != 0;
    const cv::Mat grey = present ? images.find(i, result.image_stamps_ns[i]) : cv::Mat();
    if (grey.size() == views[i].size()) cv::cvtColor(grey, views[i], cv::COLOR_GRAY2BGR);
  }

  const cv::Scalar inlier(80, 220, 60), outlier(60, 60, 240), fresh(240, 160, 40);
  const auto fixed = [](const Eigen::Vector2d& pixel) {
    return cv::Point(cvRound(pixel.x() * (1 << kSubpixelBits)), cvRound(pixel.y() * (1 << kSubpixelBits)));
  };
  for (const FeatureReport& feature : result.features) {
    cv::Mat& view = views[feature.camera];
    const cv::Scalar& color = feature.is_new ? fresh : feature.inlier ? inlier : outlier;
    if (!feature.is_new) {
      cv::line(view, fixed(feature.previous_pixel), fixed(feature.pixel), color, 1, cv::LINE_AA, kSubpixelBits);
    }
    cv::circle(view, fixed(feature.pixel), 2 << kSubpixelBits, color, cv::FILLED, cv::LINE_AA, kSubpixelBits);
  }
  return canvas;
}

}  // namespace multicam_egomotion
