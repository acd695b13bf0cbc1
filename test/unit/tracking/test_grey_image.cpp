// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <opencv2/core.hpp>
#include <stdexcept>
#include <string>

#include "multicam_egomotion/tracking/grey_image.h"

namespace multicam_egomotion {
namespace {

// ITU-R BT.601 luma.
int luma(int red, int green, int blue) {
  return static_cast<int>(std::lround(0.299 * red + 0.587 * green + 0.114 * blue));
}

void expectConstant(const cv::Mat& grey, int value) {
  ASSERT_EQ(grey.type(), CV_8UC1);
  for (int row = 0; row < grey.rows; ++row) {
    for (int column = 0; column < grey.cols; ++column) {
      ASSERT_NEAR(grey.at<std::uint8_t>(row, column), value, 1) << row << " " << column;
    }
  }
}

TEST(GreyImage, GreyIsNotCopied) {
  const cv::Mat pixels(4, 6, CV_8UC1, cv::Scalar(77));
  for (const char* encoding : {"mono8", "8UC1"}) {
    const cv::Mat grey = toGrey(pixels, encoding);
    EXPECT_EQ(grey.data, pixels.data);
    EXPECT_EQ(grey.size(), pixels.size());
  }
}

TEST(GreyImage, SixteenBitsKeepTheUpperEight) {
  cv::Mat whole(4, 10, CV_16UC1, cv::Scalar(0));
  const cv::Mat pixels = whole.colRange(2, 8);  // rows are not contiguous
  whole.at<std::uint16_t>(1, 3) = 0xABCD;
  whole.at<std::uint16_t>(3, 7) = 0xFFFF;
  whole.at<std::uint16_t>(3, 6) = 0x00FF;
  for (const char* encoding : {"mono16", "16UC1"}) {
    const cv::Mat grey = toGrey(pixels, encoding);
    ASSERT_EQ(grey.type(), CV_8UC1);
    EXPECT_EQ(grey.at<std::uint8_t>(1, 1), 0xAB);
    EXPECT_EQ(grey.at<std::uint8_t>(3, 5), 0xFF);
    EXPECT_EQ(grey.at<std::uint8_t>(3, 4), 0x00);
  }
}

TEST(GreyImage, ColorsAreWeightedByTheirChannel) {
  const int red = 200, green = 90, blue = 20;
  const cv::Mat bgr(4, 6, CV_8UC3, cv::Scalar(blue, green, red)), rgb(4, 6, CV_8UC3, cv::Scalar(red, green, blue));
  const cv::Mat bgra(4, 6, CV_8UC4, cv::Scalar(blue, green, red, 9)),
      rgba(4, 6, CV_8UC4, cv::Scalar(red, green, blue, 9));
  const int expected = luma(red, green, blue);
  expectConstant(toGrey(bgr, "bgr8"), expected);
  expectConstant(toGrey(bgr, "8UC3"), expected);
  expectConstant(toGrey(rgb, "rgb8"), expected);
  expectConstant(toGrey(bgra, "bgra8"), expected);
  expectConstant(toGrey(bgra, "8UC4"), expected);
  expectConstant(toGrey(rgba, "rgba8"), expected);
  EXPECT_GT(std::abs(luma(blue, green, red) - expected), 20);  // swapped channels would show
}

// A plain colour seen through each filter pattern: the name spells the first two rows.
TEST(GreyImage, BayerPatternsStartWithTheNamedColors) {
  for (const std::string pattern : {"rggb", "bggr", "gbrg", "grbg"}) {
    cv::Mat pixels(16, 16, CV_8UC1);
    const int red = 200, green = 90, blue = 20;
    for (int row = 0; row < 16; ++row) {
      for (int column = 0; column < 16; ++column) {
        const char filter = pattern[2 * (row % 2) + column % 2];
        pixels.at<std::uint8_t>(row, column) = filter == 'r' ? red : filter == 'g' ? green : blue;
      }
    }
    SCOPED_TRACE(pattern);
    expectConstant(toGrey(pixels, "bayer_" + pattern + "8"), luma(red, green, blue));
  }
}

void expectRefusal(const cv::Mat& pixels, const std::string& encoding, const std::string& part) {
  try {
    toGrey(pixels, encoding);
    ADD_FAILURE() << "accepted " << encoding;
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find("'" + encoding + "'"), std::string::npos) << error.what();
  }
}

TEST(GreyImage, RefusesWhatItDoesNotKnow) {
  const cv::Mat pixels(4, 6, CV_8UC1, cv::Scalar(0));
  expectRefusal(pixels, "yuv422", "mono8, 8UC1, mono16");
  expectRefusal(pixels, "", "bayer_rggb8");
  expectRefusal(pixels, "bgr8", "expected");
  expectRefusal(cv::Mat(), "mono8", "empty");
}

}  // namespace
}  // namespace multicam_egomotion
