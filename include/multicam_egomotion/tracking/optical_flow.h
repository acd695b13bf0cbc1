// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>
#include <vector>

namespace multicam_egomotion {

struct OpticalFlowOptions {
  int patch_size_px = 15;
  int pyramid_levels = 4;
  int max_iterations = 20;   ///< a level
  double epsilon_px = 0.02;  ///< stops when an iteration moves the patch less
  double max_forward_backward_error_px = 0.7;
};

/// Pyramid of one image, built once and used for every flow from and to it.
class FlowPyramid {
 public:
  /// Copies the image, CV_8UC1; uses the memory of the pyramid that was here where it has the size.
  void build(const cv::Mat& grey, const OpticalFlowOptions& options);

  bool empty() const { return images_.empty(); }
  /// Grey images, finest first, each half the size of the one before; at least one.
  const std::vector<cv::Mat>& images() const { return images_; }
  const std::vector<cv::Mat>& imagesAndDerivatives() const { return images_and_derivatives_; }

 private:
  std::vector<cv::Mat> images_and_derivatives_;
  std::vector<cv::Mat> images_;
};

/// Pyramidal Lucas-Kanade from `previous` to `current` over the finest `levels` levels. `points` [px] in the previous
/// image; `guesses`: predicted positions in, results out. `found`: 0 where a point was lost.
void flowForward(const FlowPyramid& previous, const FlowPyramid& current, const OpticalFlowOptions& options, int levels,
                 const std::vector<cv::Point2f>& points, std::vector<cv::Point2f>* guesses,
                 std::vector<unsigned char>* found);

/// Whether the flow of each point from `current` back to `previous` ends within max_forward_backward_error_px of where
/// it started. `origins` [px] in the previous image, `points` in the current one.
void flowReturns(const FlowPyramid& previous, const FlowPyramid& current, const OpticalFlowOptions& options,
                 const std::vector<cv::Point2f>& origins, const std::vector<cv::Point2f>& points,
                 std::vector<unsigned char>* returns);

}  // namespace multicam_egomotion
