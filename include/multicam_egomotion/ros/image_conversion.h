// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sensor_msgs/CompressedImage.h>
#include <sensor_msgs/Image.h>

#include <opencv2/core/mat.hpp>

namespace multicam_egomotion {

/// Grey pixels (CV_8UC1) with memory of their own. Throws std::invalid_argument, with found and expected, on an
/// encoding that is not known, a size that does not fit the data, or a compressed image that cannot be decoded.
cv::Mat greyPixels(const sensor_msgs::Image& image);
cv::Mat greyPixels(const sensor_msgs::CompressedImage& image);

}  // namespace multicam_egomotion
