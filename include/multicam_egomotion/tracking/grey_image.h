// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core/mat.hpp>
#include <string>

namespace multicam_egomotion {

/// 8-bit grey image (CV_8UC1) of an image in one of sensor_msgs' encodings: mono8, 8UC1 (returned without a copy:
/// shares the pixels), mono16, 16UC1 (the upper 8 of 16 bits), bgr8, 8UC3 (as bgr8), rgb8, bgra8, 8UC4 (as bgra8),
/// rgba8, bayer_{rggb,bggr,gbrg,grbg}8. Throws std::invalid_argument on another encoding, on an empty image, and on
/// pixels that are not of the encoding's type.
cv::Mat toGrey(const cv::Mat& pixels, const std::string& encoding);

}  // namespace multicam_egomotion
