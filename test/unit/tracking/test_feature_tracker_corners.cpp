// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "multicam_egomotion/tracking/corner_detector.h"

namespace multicam_egomotion {
namespace {

const cv::Size kSize(320, 240);

cv::Mat texture() {
  cv::Mat image(kSize, CV_8UC1);
  cv::RNG(5).fill(image, cv::RNG::UNIFORM, 0, 256);
  cv::GaussianBlur(image, image, {}, 1.5);
  cv::normalize(image, image, 0, 255, cv::NORM_MINMAX);
  return image;
}

double nearest(const std::vector<cv::Point2f>& points, const cv::Point2f& point) {
  double distance = 1e9;
  for (const cv::Point2f& other : points) {
    if (other != point) distance = std::min(distance, cv::norm(other - point));
  }
  return distance;
}

TEST(CornerDetector, SpreadsCornersAndKeepsTheirDistance) {
  CornerDetectorOptions options;
  options.features = 100;
  CornerDetector detector(kSize, options);
  const std::vector<cv::Point2f> corners = detector.detect(texture(), cv::Mat(), {});
  EXPECT_EQ(corners.size(), 100u);
  int quadrants[4] = {};
  for (const cv::Point2f& corner : corners) {
    EXPECT_GT(nearest(corners, corner), options.min_distance_px);
    EXPECT_TRUE(corner.x >= options.border_px && corner.x < kSize.width - options.border_px);
    EXPECT_TRUE(corner.y >= options.border_px && corner.y < kSize.height - options.border_px);
    ++quadrants[(corner.x < 160 ? 0 : 1) + (corner.y < 120 ? 0 : 2)];
  }
  for (const int count : quadrants) EXPECT_GE(count, 15);
}

TEST(CornerDetector, FillsOnlyWhatIsMissing) {
  CornerDetectorOptions options;
  options.features = 100;
  CornerDetector detector(kSize, options);
  std::vector<cv::Point2f> corners = detector.detect(texture(), cv::Mat(), {});
  EXPECT_TRUE(detector.detect(texture(), cv::Mat(), corners).empty());
  const auto on_the_left = [](const cv::Point2f& corner) { return corner.x < 160; };
  corners.erase(std::remove_if(corners.begin(), corners.end(), on_the_left), corners.end());
  const std::vector<cv::Point2f> added = detector.detect(texture(), cv::Mat(), corners);
  EXPECT_GT(added.size(), 30u);
  for (const cv::Point2f& corner : added) EXPECT_GT(nearest(corners, corner), options.min_distance_px);
}

TEST(CornerDetector, RespectsTheMaskAndFindsNothingInNothing) {
  CornerDetector detector(kSize, CornerDetectorOptions());
  cv::Mat mask(kSize, CV_8UC1, cv::Scalar(255));
  mask.rowRange(0, 120).setTo(0);
  const std::vector<cv::Point2f> corners = detector.detect(texture(), mask, {});
  EXPECT_GT(corners.size(), 40u);
  for (const cv::Point2f& corner : corners) EXPECT_GE(corner.y, 120);
  for (const int grey : {0, 255}) {
    EXPECT_TRUE(detector.detect(cv::Mat(kSize, CV_8UC1, cv::Scalar(grey)), cv::Mat(), {}).empty());
  }
}

TEST(CornerDetector, TakesImagesOfAnySize) {
  for (const cv::Size size : {cv::Size(1, 1), cv::Size(12, 9), cv::Size(40, 3), cv::Size(2000, 20)}) {
    CornerDetector detector(size, CornerDetectorOptions());
    cv::Mat image(size, CV_8UC1);
    cv::RNG(1).fill(image, cv::RNG::UNIFORM, 0, 256);
    detector.detect(image, cv::Mat(), {});
  }
}

}  // namespace
}  // namespace multicam_egomotion
