// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>
#include <vector>

namespace multicam_egomotion {

struct CornerDetectorOptions {
  int features = 150;            ///< wanted in the whole image, with those that exist already
  int min_distance_px = 12;      ///< between two features
  int fast_threshold = 10;       ///< [grey levels]
  int border_px = 8;             ///< strip along the image border without features
  double min_eigenvalue = 30.0;  ///< smaller eigenvalue of the mean structure tensor over 7x7 px [grey^2/px^2]
};

/// FAST corners (Rosten and Drummond, ECCV 2006), ranked by the smaller eigenvalue of the structure tensor (Shi and
/// Tomasi, CVPR 1994), spread over a grid: only cells with too few features are searched.
class CornerDetector {
 public:
  CornerDetector(const cv::Size& image_size, const CornerDetectorOptions& options);

  /// New corners, best first within a cell. `occupied`: the features that exist already.
  /// `image`: CV_8UC1; `mask`: CV_8UC1 or empty, 0 = ignore.
  std::vector<cv::Point2f> detect(const cv::Mat& image, const cv::Mat& mask, const std::vector<cv::Point2f>& occupied);

 private:
  struct Candidate {
    cv::Point point;
    float score;
    int cell;
  };

  int cellOf(const cv::Point2f& point) const;
  void occupy(const cv::Point& point);
  std::vector<Candidate> candidatesIn(const cv::Mat& image, int cell, const cv::Rect& inner) const;

  CornerDetectorOptions options_;
  cv::Size image_size_;
  int columns_, rows_;
  std::vector<int> rest_;  ///< frames for which a cell is not searched
  cv::Mat free_;           ///< CV_8UC1, 0 within min_distance_px of a feature
};

}  // namespace multicam_egomotion
