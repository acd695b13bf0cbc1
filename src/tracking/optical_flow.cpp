// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "multicam_egomotion/tracking/optical_flow.h"

#include <algorithm>
#include <opencv2/video/tracking.hpp>

namespace multicam_egomotion {
namespace {

// Backwards the start is known: a patch that truly matches stays there, so that one coarser level is enough.
constexpr int kBackwardLevels = 2;

cv::TermCriteria criteria(const OpticalFlowOptions& options) {
  return {cv::TermCriteria::COUNT + cv::TermCriteria::EPS, options.max_iterations, options.epsilon_px};
}

}  // namespace

void FlowPyramid::build(const cv::Mat& grey, const OpticalFlowOptions& options) {
  const cv::Size patch(options.patch_size_px, options.patch_size_px);
  cv::buildOpticalFlowPyramid(grey, images_and_derivatives_, patch, options.pyramid_levels - 1, true,
                              cv::BORDER_REFLECT_101, cv::BORDER_CONSTANT, false);
  images_.clear();
  for (std::size_t i = 0; i < images_and_derivatives_.size(); i += 2) images_.push_back(images_and_derivatives_[i]);
}

void flowForward(const FlowPyramid& previous, const FlowPyramid& current, const OpticalFlowOptions& options, int levels,
                 const std::vector<cv::Point2f>& points, std::vector<cv::Point2f>* guesses,
                 std::vector<unsigned char>* found) {
  found->clear();
  if (points.empty()) return;
  std::vector<float> error;
  cv::calcOpticalFlowPyrLK(previous.imagesAndDerivatives(), current.imagesAndDerivatives(), points, *guesses, *found,
                           error, cv::Size(options.patch_size_px, options.patch_size_px), levels - 1, criteria(options),
                           cv::OPTFLOW_USE_INITIAL_FLOW);
}

void flowReturns(const FlowPyramid& previous, const FlowPyramid& current, const OpticalFlowOptions& options,
                 const std::vector<cv::Point2f>& origins, const std::vector<cv::Point2f>& points,
                 std::vector<unsigned char>* returns) {
  std::vector<cv::Point2f> returned = origins;
  flowForward(current, previous, options, std::min(kBackwardLevels, options.pyramid_levels), points, &returned,
              returns);
  const double max_squared_error = options.max_forward_backward_error_px * options.max_forward_backward_error_px;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const cv::Point2f d = returned[i] - origins[i];
    (*returns)[i] = (*returns)[i] && d.dot(d) <= max_squared_error;
  }
}

}  // namespace multicam_egomotion
