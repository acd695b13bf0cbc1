// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "multicam_egomotion/tracking/grey_image.h"

#include <cstdint>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

namespace multicam_egomotion {
namespace {

enum class Conversion { kNone, kUpperByte, kColor };

struct Encoding {
  const char* name;
  int type;
  Conversion conversion;
  int code;  // of cv::cvtColor
};

// OpenCV names a Bayer pattern by the second and third pixel of the second row: RGGB there is BG here.
const Encoding kEncodings[] = {
    {"mono8", CV_8UC1, Conversion::kNone, 0},
    {"8UC1", CV_8UC1, Conversion::kNone, 0},
    {"mono16", CV_16UC1, Conversion::kUpperByte, 0},
    {"16UC1", CV_16UC1, Conversion::kUpperByte, 0},
    {"bgr8", CV_8UC3, Conversion::kColor, cv::COLOR_BGR2GRAY},
    {"8UC3", CV_8UC3, Conversion::kColor, cv::COLOR_BGR2GRAY},
    {"rgb8", CV_8UC3, Conversion::kColor, cv::COLOR_RGB2GRAY},
    {"bgra8", CV_8UC4, Conversion::kColor, cv::COLOR_BGRA2GRAY},
    {"8UC4", CV_8UC4, Conversion::kColor, cv::COLOR_BGRA2GRAY},
    {"rgba8", CV_8UC4, Conversion::kColor, cv::COLOR_RGBA2GRAY},
    {"bayer_rggb8", CV_8UC1, Conversion::kColor, cv::COLOR_BayerBG2GRAY},
    {"bayer_bggr8", CV_8UC1, Conversion::kColor, cv::COLOR_BayerRG2GRAY},
    {"bayer_gbrg8", CV_8UC1, Conversion::kColor, cv::COLOR_BayerGR2GRAY},
    {"bayer_grbg8", CV_8UC1, Conversion::kColor, cv::COLOR_BayerGB2GRAY},
};

const Encoding& find(const std::string& name) {
  std::string known;
  for (const Encoding& encoding : kEncodings) {
    if (name == encoding.name) return encoding;
    known += std::string(known.empty() ? "" : ", ") + encoding.name;
  }
  throw std::invalid_argument("image encoding is '" + name + "', expected one of " + known);
}

}  // namespace

cv::Mat toGrey(const cv::Mat& pixels, const std::string& encoding) {
  const Encoding& from = find(encoding);
  if (pixels.empty()) throw std::invalid_argument("image of encoding '" + encoding + "' is empty, expected pixels");
  if (pixels.type() != from.type) {
    throw std::invalid_argument("image of encoding '" + encoding + "' has OpenCV type " +
                                std::to_string(pixels.type()) + ", expected " + std::to_string(from.type));
  }
  cv::Mat grey;
  switch (from.conversion) {
    case Conversion::kNone:
      return pixels;
    case Conversion::kUpperByte:
      grey.create(pixels.size(), CV_8UC1);
      for (int row = 0; row < pixels.rows; ++row) {
        const std::uint16_t* in = pixels.ptr<std::uint16_t>(row);
        std::uint8_t* out = grey.ptr<std::uint8_t>(row);
        for (int column = 0; column < pixels.cols; ++column) out[column] = static_cast<std::uint8_t>(in[column] >> 8);
      }
      return grey;
    case Conversion::kColor:
      cv::cvtColor(pixels, grey, from.code);
      return grey;
  }
  return grey;
}

}  // namespace multicam_egomotion
