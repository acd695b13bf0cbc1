// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "multicam_egomotion/tracking/patch_alignment.h"

namespace multicam_egomotion {
namespace {

// A smooth pattern, so that it can be sampled anywhere; gain and offset of the brightness.
double pattern(double x, double y) {
  return 110 + 40 * std::sin(0.45 * x + 0.1 * y) + 35 * std::cos(0.38 * y - 0.15 * x) + 20 * std::sin(0.3 * (x + y));
}

// Image in which the patch around `center` of the pattern appears through `warp`.
cv::Mat render(const Eigen::Vector2d& center, const PatchWarp& warp, double gain, double offset) {
  cv::Mat image(80, 100, CV_8UC1);
  const Eigen::Matrix2d inverse = warp.linear.inverse();
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      const Eigen::Vector2d p = center + inverse * (Eigen::Vector2d(x, y) - warp.pixel);
      image.at<uchar>(y, x) = cv::saturate_cast<uchar>(gain * pattern(p.x(), p.y()) + offset);
    }
  }
  return image;
}

const Eigen::Vector2d kCenter(45.3, 38.8);

cv::Mat source() { return render(kCenter, {kCenter, Eigen::Matrix2d::Identity()}, 1.0, 0.0); }

TEST(PatchTemplate, FindsAShiftDespiteGainAndOffset) {
  for (const WarpModel model : {WarpModel::kTranslation, WarpModel::kAffine}) {
    PatchTemplate patch;
    ASSERT_TRUE(patch.cut(source(), {kCenter, Eigen::Matrix2d::Identity()}, 15, model));
    const PatchWarp truth{kCenter + Eigen::Vector2d(1.37, -0.82), Eigen::Matrix2d::Identity()};
    PatchWarp warp{kCenter, Eigen::Matrix2d::Identity()};
    double correlation = 0;
    ASSERT_TRUE(patch.align(render(kCenter, truth, 0.6, 50), PatchAlignmentOptions(), &warp, &correlation));
    EXPECT_LT((warp.pixel - truth.pixel).norm(), 0.03);
    EXPECT_GT(correlation, 0.99);
  }
}

TEST(PatchTemplate, FollowsAnAffineDeformation) {
  PatchTemplate patch;
  ASSERT_TRUE(patch.cut(source(), {kCenter, Eigen::Matrix2d::Identity()}, 15, WarpModel::kAffine));
  PatchWarp truth{kCenter, Eigen::Matrix2d::Identity()};
  PatchWarp warp = truth;
  for (int k = 0; k < 10; ++k) {
    truth.pixel += Eigen::Vector2d(0.4, 0.3);
    Eigen::Matrix2d growth;
    growth << 1.03, 0.01, -0.01, 1.03;
    truth.linear = truth.linear * growth;
    ASSERT_TRUE(patch.align(render(kCenter, truth, 1.0, 0), PatchAlignmentOptions(), &warp));
    EXPECT_LT((warp.pixel - truth.pixel).norm(), 0.05);
  }
  EXPECT_LT((warp.linear - truth.linear).norm(), 0.05);
}

TEST(PatchTemplate, CutsThroughAWarp) {
  PatchWarp shown{Eigen::Vector2d(50, 40), Eigen::Matrix2d::Identity()};
  shown.linear << 0.9, 0.3, -0.25, 1.1;
  PatchTemplate patch;
  ASSERT_TRUE(patch.cut(render(kCenter, shown, 1.0, 0), shown, 15, WarpModel::kTranslation));
  EXPECT_GT(patch.correlation(source(), {kCenter, Eigen::Matrix2d::Identity()}), 0.99);
  EXPECT_LT(patch.correlation(source(), {kCenter + Eigen::Vector2d(5, 0), Eigen::Matrix2d::Identity()}), 0.7);
}

TEST(PatchTemplate, RefusesWhatCannotBeAligned) {
  PatchTemplate patch;
  const PatchWarp warp{kCenter, Eigen::Matrix2d::Identity()};
  EXPECT_FALSE(patch.cut(cv::Mat(80, 100, CV_8UC1, cv::Scalar(90)), warp, 15, WarpModel::kAffine));
  cv::Mat edge(80, 100, CV_8UC1, cv::Scalar(40));
  edge.colRange(45, 100).setTo(200);
  EXPECT_FALSE(patch.cut(edge, warp, 15, WarpModel::kTranslation));
  EXPECT_FALSE(patch.cut(source(), {Eigen::Vector2d(4, 30), Eigen::Matrix2d::Identity()}, 15, WarpModel::kAffine));
  EXPECT_FALSE(patch.cut(source(), {Eigen::Vector2d(NAN, 30), Eigen::Matrix2d::Identity()}, 15, WarpModel::kAffine));

  ASSERT_TRUE(patch.cut(source(), warp, 15, WarpModel::kAffine));
  PatchWarp moved = warp;
  EXPECT_FALSE(patch.align(cv::Mat(80, 100, CV_8UC1, cv::Scalar(90)), PatchAlignmentOptions(), &moved));
  cv::Mat noise(80, 100, CV_8UC1);
  cv::RNG(3).fill(noise, cv::RNG::UNIFORM, 0, 256);
  EXPECT_FALSE(patch.align(noise, PatchAlignmentOptions(), &moved));
  EXPECT_EQ(moved.pixel, warp.pixel);
}

}  // namespace
}  // namespace multicam_egomotion
