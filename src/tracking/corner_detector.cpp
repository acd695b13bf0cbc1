// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "multicam_egomotion/tracking/corner_detector.h"

#include <algorithm>
#include <cmath>
#include <opencv2/core/utility.hpp>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>

namespace multicam_egomotion {
namespace {

constexpr int kFeaturesPerCell = 2;
// Cells with much texture may take more when others have none.
constexpr int kMaxFeaturesPerCell = 4;
constexpr std::size_t kMaxCandidatesPerCell = 12;
// A cell that had nothing to offer is left alone for so many frames while the image is well covered.
constexpr int kRest = 3;
constexpr int kScoreRadius = 3;
constexpr int kFastRadius = 3;
constexpr double kGroups = 8;  // of cells that are searched at the same time

// Smaller eigenvalue of the structure tensor, mean over the window; central differences.
float cornerScore(const cv::Mat& image, const cv::Point& point) {
  int xx = 0, xy = 0, yy = 0;
  for (int y = point.y - kScoreRadius; y <= point.y + kScoreRadius; ++y) {
    const auto* row = image.ptr<uchar>(y);
    const auto* above = image.ptr<uchar>(y - 1);
    const auto* below = image.ptr<uchar>(y + 1);
    for (int x = point.x - kScoreRadius; x <= point.x + kScoreRadius; ++x) {
      const int gx = row[x + 1] - row[x - 1];
      const int gy = below[x] - above[x];
      xx += gx * gx;
      xy += gx * gy;
      yy += gy * gy;
    }
  }
  constexpr float kPixels = (2 * kScoreRadius + 1) * (2 * kScoreRadius + 1);
  const float trace = xx + yy;
  const float difference = xx - yy;
  // A central difference over two pixels is twice the gradient.
  return 0.5f * (trace - std::sqrt(difference * difference + 4.0f * xy * xy)) / (4.0f * kPixels);
}

}  // namespace

CornerDetector::CornerDetector(const cv::Size& image_size, const CornerDetectorOptions& options)
    : options_(options), image_size_(image_size), free_(image_size, CV_8UC1) {
  const double cells = std::max(1.0, static_cast<double>(options.features) / kFeaturesPerCell);
  const double side = std::sqrt(image_size.area() / cells);
  columns_ = std::max(1, static_cast<int>(std::lround(image_size.width / side)));
  rows_ = std::max(1, static_cast<int>(std::lround(image_size.height / side)));
  rest_.assign(columns_ * rows_, 0);
}

int CornerDetector::cellOf(const cv::Point2f& point) const {
  const int column = std::clamp(static_cast<int>(point.x * columns_ / image_size_.width), 0, columns_ - 1);
  const int row = std::clamp(static_cast<int>(point.y * rows_ / image_size_.height), 0, rows_ - 1);
  return row * columns_ + column;
}

void CornerDetector::occupy(const cv::Point& point) {
  const int d = options_.min_distance_px;
  const cv::Rect square(point.x - d, point.y - d, 2 * d + 1, 2 * d + 1);
  free_(square & cv::Rect({0, 0}, image_size_)).setTo(0);
}

std::vector<CornerDetector::Candidate> CornerDetector::candidatesIn(const cv::Mat& image, int cell,
                                                                    const cv::Rect& inner) const {
  const int column = cell % columns_;
  const int row = cell / columns_;
  const int x0 = column * image_size_.width / columns_;
  const int y0 = row * image_size_.height / rows_;
  const cv::Rect area =
      cv::Rect(x0, y0, (column + 1) * image_size_.width / columns_ - x0, (row + 1) * image_size_.height / rows_ - y0) &
      inner;
  if (area.empty()) return {};
  const cv::Rect padded = cv::Rect(area.x - kFastRadius, area.y - kFastRadius, area.width + 2 * kFastRadius,
                                   area.height + 2 * kFastRadius) &
                          cv::Rect({0, 0}, image_size_);
  std::vector<cv::KeyPoint> keypoints;
  cv::FAST(image(padded), keypoints, options_.fast_threshold, true);
  const auto ranked = [](const cv::KeyPoint& a, const cv::KeyPoint& b) {
    if (a.response != b.response) return a.response > b.response;
    return a.pt.y != b.pt.y ? a.pt.y < b.pt.y : a.pt.x < b.pt.x;
  };
  std::sort(keypoints.begin(), keypoints.end(), ranked);
  std::vector<Candidate> candidates;
  for (const cv::KeyPoint& keypoint : keypoints) {
    const cv::Point point(cvRound(keypoint.pt.x) + padded.x, cvRound(keypoint.pt.y) + padded.y);
    if (!area.contains(point) || free_.at<uchar>(point) == 0) continue;
    const float score = cornerScore(image, point);
    if (score < options_.min_eigenvalue) continue;
    candidates.push_back({point, score, cell});
    if (candidates.size() == kMaxCandidatesPerCell) break;
  }
  return candidates;
}

std::vector<cv::Point2f> CornerDetector::detect(const cv::Mat& image, const cv::Mat& mask,
                                                const std::vector<cv::Point2f>& occupied) {
  if (static_cast<int>(occupied.size()) >= options_.features) return {};
  std::vector<int> count(columns_ * rows_, 0);
  if (mask.empty()) {
    free_.setTo(255);
  } else {
    mask.copyTo(free_);
  }
  for (const cv::Point2f& point : occupied) {
    ++count[cellOf(point)];
    occupy(cv::Point(cvRound(point.x), cvRound(point.y)));
  }

  const int border = std::max(options_.border_px, kScoreRadius + 1);
  const cv::Rect inner(border, border, image_size_.width - 2 * border, image_size_.height - 2 * border);
  const bool well_covered = 3 * static_cast<int>(occupied.size()) > 2 * options_.features;
  std::vector<int> cells;
  for (int cell = 0; cell < columns_ * rows_; ++cell) {
    if (count[cell] >= kFeaturesPerCell) continue;
    if (well_covered && rest_[cell] > 0) {
      --rest_[cell];
      continue;
    }
    rest_[cell] = kRest;
    cells.push_back(cell);
  }
  std::vector<std::vector<Candidate>> found(cells.size());
  cv::parallel_for_(
      cv::Range(0, static_cast<int>(cells.size())),
      [&](const cv::Range& range) {
        for (int i = range.start; i < range.end; ++i) found[i] = candidatesIn(image, cells[i], inner);
      },
      kGroups);
  std::vector<Candidate> candidates;
  for (const auto& one : found) candidates.insert(candidates.end(), one.begin(), one.end());
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.score > b.score; });

  std::vector<cv::Point2f> corners;
  const auto wanted = static_cast<std::size_t>(std::max(0, options_.features - static_cast<int>(occupied.size())));
  for (const int limit : {kFeaturesPerCell, kMaxFeaturesPerCell}) {
    for (const Candidate& candidate : candidates) {
      if (corners.size() >= wanted) break;
      if (count[candidate.cell] >= limit || free_.at<uchar>(candidate.point) == 0) continue;
      ++count[candidate.cell];
      occupy(candidate.point);
      rest_[candidate.cell] = 0;
      corners.emplace_back(candidate.point);
    }
  }
  return corners;
}

}  // namespace multicam_egomotion
