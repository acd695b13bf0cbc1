// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <opencv2/core.hpp>

#include "multicam_egomotion/tracking/image_monitor.h"

namespace multicam_egomotion {
namespace {

constexpr std::int64_t kPeriod = 50000000;  // [ns]
constexpr int kColumns = 160, kRows = 120;

CameraRig twoCameras() {
  std::vector<RigCamera> cameras;
  for (const char* name : {"left", "right"}) {
    cameras.push_back({name, name, CameraModel(kColumns, kRows, 100.0, 100.0, 79.5, 59.5, Distortion::kNone, {}),
                       Eigen::Isometry3d::Identity()});
  }
  return CameraRig(cameras);
}

cv::Mat texture(int seed, double mean = 128.0, double sigma = 30.0) {
  cv::Mat grey(kRows, kColumns, CV_8UC1);
  cv::RNG random(seed);
  random.fill(grey, cv::RNG::NORMAL, mean, sigma);
  return grey;
}

class ImageMonitorTest : public ::testing::Test {
 protected:
  // Cameras that are left in the set after the pictures have been looked at; an empty picture is no image.
  std::vector<int> kept(const cv::Mat& left, const cv::Mat& right, double rotation = 0.0, bool translation = false) {
    FrameSet set;
    set.stamp_ns = ++frame_ * kPeriod;
    if (!left.empty()) set.images.push_back({0, set.stamp_ns, left});
    if (!right.empty()) set.images.push_back({1, set.stamp_ns, right});
    ExpectedMotion motion;
    motion.rotation.z() = rotation;
    motion.translation = translation;
    motion.duration_s = 1e-9 * kPeriod;
    monitor_.takeOutFrozen(motion, &set);
    std::vector<int> cameras;
    for (const CameraImage& image : set.images) cameras.push_back(image.camera);
    return cameras;
  }

  bool says(const std::string& text) const {
    const std::vector<std::string> faults = monitor_.faults();
    return std::any_of(faults.begin(), faults.end(),
                       [&](const std::string& fault) { return fault.find(text) != std::string::npos; });
  }

  const std::vector<int> both_ = {0, 1}, left_ = {0}, none_ = {};
  ImageMonitor monitor_{twoCameras()};
  int frame_ = 0;
};

TEST_F(ImageMonitorTest, NothingIsWrongWithPicturesThatChange) {
  for (int i = 0; i < 20; ++i) EXPECT_EQ(kept(texture(2 * i), texture(2 * i + 1), 0.1, true), both_);
  EXPECT_TRUE(monitor_.faults().empty());
}

TEST_F(ImageMonitorTest, AStandingPictureWithoutNoiseIsKept) {
  const cv::Mat left = texture(1), right = texture(2);
  for (int i = 0; i < 40; ++i) EXPECT_EQ(kept(left, right, i % 2 ? 0.002 : -0.002), both_) << i;
  EXPECT_TRUE(monitor_.faults().empty());
}

TEST_F(ImageMonitorTest, ThePictureOfABodyThatTurnsIsFrozen) {
  const cv::Mat left = texture(1), right = texture(2);
  EXPECT_EQ(kept(left, right, 0.004), both_);
  EXPECT_EQ(kept(left, right, 0.004), both_);  // 0.23 deg since the first
  for (int i = 0; i < 7; ++i) EXPECT_EQ(kept(left, right, 0.006), none_) << i;
  EXPECT_TRUE(says("left: same picture since 0.4 s, frozen?"));
  EXPECT_TRUE(says("right: same picture since 0.4 s, frozen?"));
  EXPECT_EQ(kept(texture(3), texture(4), 0.006), both_);
  EXPECT_TRUE(monitor_.faults().empty());
}

TEST_F(ImageMonitorTest, AnUncertainRotationProvesNothing) {
  const cv::Mat picture = texture(1);
  FrameSet set;
  set.images.push_back({0, 1, picture});
  ExpectedMotion motion;
  motion.rotation.x() = 0.02;
  motion.rotation_sigma = 0.01;
  for (int i = 0; i < 2; ++i) monitor_.takeOutFrozen(motion, &set);
  EXPECT_EQ(set.images.size(), 1u);
}

TEST_F(ImageMonitorTest, ThePictureOfABodyThatMovesIsFrozen) {
  const cv::Mat left = texture(1);
  EXPECT_EQ(kept(left, cv::Mat(), 0.0, true), left_);
  EXPECT_EQ(kept(left, cv::Mat(), 0.0, true), none_);
}

TEST_F(ImageMonitorTest, OneCameraIsFrozenWhereAnotherSeesChange) {
  const cv::Mat right = texture(100);
  EXPECT_EQ(kept(texture(0), right), both_);
  EXPECT_EQ(kept(texture(1), right), both_);
  for (int i = 2; i < 6; ++i) EXPECT_EQ(kept(texture(i), right), left_);
  EXPECT_TRUE(says("right: same picture"));
  EXPECT_FALSE(says("left"));
}

TEST_F(ImageMonitorTest, NamesPicturesThatShowNothing) {
  const cv::Mat grey(kRows, kColumns, CV_8UC1, cv::Scalar(90));
  for (int i = 0; i < 3; ++i) {
    EXPECT_TRUE(monitor_.faults().empty());
    EXPECT_EQ(kept(texture(i, 4.0, 1.0), texture(i, 254.0, 20.0), 0.1, true), both_);
  }
  EXPECT_TRUE(says("left: dark"));
  EXPECT_TRUE(says("right: saturated"));
  for (int i = 0; i < 3; ++i) EXPECT_EQ(kept(grey, texture(i), 0.1, true), both_);
  EXPECT_TRUE(says("left: no contrast"));
  EXPECT_FALSE(says("frozen"));
  EXPECT_FALSE(says("right"));
}

TEST_F(ImageMonitorTest, NamesBothSizes) {
  EXPECT_TRUE(monitor_.fits({0, 1, texture(0)}));
  EXPECT_FALSE(monitor_.fits({1, 1, cv::Mat(240, 320, CV_8UC1, cv::Scalar(1))}));
  EXPECT_TRUE(says("right: image is 320x240, expected 160x120"));
  EXPECT_EQ(monitor_.wrongSizes(), 1u);
  EXPECT_FALSE(monitor_.rightSize(1));
  EXPECT_TRUE(monitor_.fits({1, 1, texture(0)}));
  EXPECT_TRUE(monitor_.faults().empty());
}

}  // namespace
}  // namespace multicam_egomotion
