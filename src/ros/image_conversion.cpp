// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "multicam_egomotion/ros/image_conversion.h"

#include <cv_bridge/cv_bridge.h>

#include <algorithm>
#include <opencv2/imgcodecs.hpp>
#include <stdexcept>

#include "multicam_egomotion/tracking/grey_image.h"

namespace multicam_egomotion {
namespace {

const std::vector<std::uint8_t> kJpegStart = {0xFF, 0xD8, 0xFF};
const std::vector<std::uint8_t> kPngStart = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'};

bool startsWith(const std::vector<std::uint8_t>& data, const std::vector<std::uint8_t>& start) {
  return data.size() >= start.size() && std::equal(start.begin(), start.end(), data.begin());
}

}  // namespace

cv::Mat greyPixels(const sensor_msgs::Image& image) {
  int type = 0;
  try {
    type = cv_bridge::getCvType(image.encoding);
  } catch (const cv_bridge::Exception&) {
    throw std::invalid_argument("found encoding '" + image.encoding + "', expected one of sensor_msgs/image_encodings");
  }
  const std::size_t row = static_cast<std::size_t>(image.width) * CV_ELEM_SIZE(type);
  const std::size_t size = static_cast<std::size_t>(image.step) * image.height;
  if (image.width == 0 || image.height == 0 || image.step < row || image.data.size() < size) {
    throw std::invalid_argument("found " + std::to_string(image.data.size()) + " bytes with a step of " +
                                std::to_string(image.step) + ", expected " + std::to_string(image.width) + "x" +
                                std::to_string(image.height) + " pixels of " + image.encoding);
  }
  if (image.is_bigendian && CV_ELEM_SIZE1(type) > 1) {
    throw std::invalid_argument("found big-endian " + image.encoding + ", expected little-endian");
  }
  try {
    const cv::Mat shared(static_cast<int>(image.height), static_cast<int>(image.width), type,
                         const_cast<std::uint8_t*>(image.data.data()), image.step);
    const cv::Mat grey = toGrey(shared, image.encoding);
    return grey.data == shared.data ? grey.clone() : grey;  // the message may end before the odometry is done with it
  } catch (const cv::Exception& error) {  // a step that is no whole number of 16-bit pixels, for instance
    throw std::invalid_argument("found " + std::to_string(image.width) + "x" + std::to_string(image.height) +
                                " pixels of " + image.encoding + " with a step of " + std::to_string(image.step) +
                                ", refused by OpenCV: " + error.err);
  }
}

cv::Mat greyPixels(const sensor_msgs::CompressedImage& image) {
  cv::Mat pixels;
  try {
    // The decoders that OpenCV may have for other formats are not all made for data that nobody has checked: that of
    // DICOM ends the process.
    const bool known = startsWith(image.data, kJpegStart) || startsWith(image.data, kPngStart);
    if (known) pixels = cv::imdecode(image.data, cv::IMREAD_GRAYSCALE | cv::IMREAD_ANYDEPTH);
  } catch (const cv::Exception&) {  // answered below
  }
  if (pixels.empty()) {
    throw std::invalid_argument("found " + std::to_string(image.data.size()) + " bytes of '" + image.format +
                                "' that cannot be decoded, expected JPEG or PNG");
  }
  return toGrey(pixels, pixels.depth() == CV_16U ? "mono16" : "mono8");
}

}  // namespace multicam_egomotion
