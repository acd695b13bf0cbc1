// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <opencv2/core.hpp>

#include "multicam_egomotion/odometry/sensor_input.h"

namespace multicam_egomotion {
namespace {

constexpr std::int64_t kMs = 1000000;
constexpr std::int64_t kFirstStamp = 1000000 * kMs;

CameraRig twoCameras() {
  std::vector<RigCamera> cameras;
  for (const char* name : {"left", "right"}) {
    cameras.push_back({name, name, CameraModel(32, 24, 20.0, 20.0, 15.5, 11.5, Distortion::kNone, {}),
                       Eigen::Isometry3d::Identity()});
  }
  return CameraRig(cameras);
}

// 100 Hz IMU, both cameras at 20 Hz, every message as soon as its stamp.
class SensorInputTest : public ::testing::Test {
 protected:
  bool imu(int stamp_ms) {
    ImuSample sample;
    sample.stamp_ns = kFirstStamp + stamp_ms * kMs;
    sample.linear_acceleration.z() = 9.81 + 1e-4 * (stamp_ms % 70);
    now_ms_ = std::max(now_ms_, stamp_ms);
    const bool jumped = input_.addImu(sample);
    advance();
    return jumped;
  }
  bool image(int camera, int stamp_ms) {
    now_ms_ = std::max(now_ms_, stamp_ms);
    const cv::Mat grey(24, 32, CV_8UC1, cv::Scalar(100));
    const bool jumped = input_.addImage({camera, kFirstStamp + stamp_ms * kMs, grey}, kFirstStamp + now_ms_ * kMs);
    advance();
    return jumped;
  }
  // Whether no jump was told.
  bool steady(int from_ms, int to_ms, int shift_of_right_ms = 0) {
    bool jumped = false;
    for (int ms = from_ms; ms < to_ms; ms += 10) {
      jumped = imu(ms) || jumped;
      if (ms % 50 != 0) continue;
      jumped = image(0, ms) || jumped;
      jumped = image(1, ms + shift_of_right_ms) || jumped;
    }
    return !jumped;
  }
  bool says(const std::string& text) const {
    const std::vector<std::string> faults = input_.faults();
    return std::find(faults.begin(), faults.end(), text) != faults.end();
  }
  EgoMotionCounters counters() const {
    EgoMotionCounters counters;
    input_.count(&counters);
    return counters;
  }

  SensorInput input_{twoCameras(), ImuCalibration(), EgoMotionOptions()};
  int now_ms_ = 0;         // of the caller, does not follow small jumps back
  std::vector<int> sets_;  // cameras in each

 private:
  void advance() {
    input_.advance(kFirstStamp + now_ms_ * kMs);
    while (const auto set = input_.next()) sets_.push_back(static_cast<int>(set->images.size()));
  }
};

TEST_F(SensorInputTest, GivesSetsOnceTheImuIsThere) {
  EXPECT_TRUE(steady(0, 1000));
  EXPECT_EQ(sets_, std::vector<int>(20, 2));
  image(0, 1000);
  image(1, 1000);
  EXPECT_EQ(sets_.size(), 20u);
  EXPECT_TRUE(input_.waiting());
  imu(1000);
  EXPECT_EQ(sets_.size(), 21u);
}

TEST_F(SensorInputTest, ASmallJumpBackIsToldByTheImuAndAnImage) {
  steady(0, 5000);
  const std::size_t before = sets_.size();
  EXPECT_FALSE(imu(4700));
  EXPECT_TRUE(image(0, 4700));
  EXPECT_FALSE(image(1, 4700));
  EXPECT_TRUE(steady(4710, 5700));
  EXPECT_EQ(sets_.size(), before + 20);
  EXPECT_EQ(*std::min_element(sets_.begin(), sets_.end()), 2);
  EXPECT_EQ(counters().late_images + counters().rejected_images + counters().rejected_imu, 0u);
}

TEST_F(SensorInputTest, AJumpBackIsToldByTwoSamplesOrTwoImages) {
  steady(0, 5000);
  EXPECT_FALSE(imu(4700));
  EXPECT_TRUE(imu(4710));
  EXPECT_TRUE(steady(4720, 5720));
  EXPECT_FALSE(image(0, 2000));
  EXPECT_TRUE(image(1, 2000));
  EXPECT_FALSE(image(0, 2050));
}

TEST_F(SensorInputTest, OneCameraWithAnotherClockIsNoJump) {
  steady(0, 5000);
  sets_.clear();
  EXPECT_TRUE(steady(5000, 7000, -3000));
  EXPECT_EQ(sets_.back(), 1);
  EXPECT_GE(counters().rejected_images, 39u);
}

TEST_F(SensorInputTest, NamesACameraThatIsMissingOrLate) {
  EXPECT_TRUE(input_.faults().empty());
  steady(0, 1000);
  EXPECT_TRUE(input_.faults().empty());
  for (int ms = 1000; ms < 1500; ms += 10) {
    imu(ms);
    if (ms % 50 == 0) image(1, ms);
  }
  EXPECT_TRUE(says("no images of left"));
  EXPECT_FALSE(says("no images of right"));
  for (int ms = 1500; ms < 2500; ms += 10) {
    imu(ms);
    if (ms % 50 == 0) image(1, ms);
    if (ms % 50 == 0) image(0, ms - 200);
  }
  EXPECT_TRUE(says("images too late of left"));
  EXPECT_TRUE(steady(2500, 3500));
  EXPECT_TRUE(input_.faults().empty());
}

TEST_F(SensorInputTest, SaysThatImuAndImagesAreApart) {
  const std::string why = ": silent, late, or clocks apart?";
  steady(0, 1000);
  EXPECT_TRUE(input_.faults().empty());
  for (int ms = 1000; ms <= 1490; ms += 50) image(0, ms), image(1, ms);
  EXPECT_TRUE(says("IMU: newest sample 0.5 s behind the images" + why)) << input_.faults().size();
  steady(1450, 1550);
  EXPECT_FALSE(says("IMU: newest sample 0.5 s behind the images" + why));
  for (int ms = 1550; ms < 8000; ms += 10) imu(ms);
  EXPECT_TRUE(says("images: newest 6.5 s behind the IMU" + why));
}

}  // namespace
}  // namespace multicam_egomotion
