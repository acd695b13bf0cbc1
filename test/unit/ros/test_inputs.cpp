// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <sensor_msgs/image_encodings.h>

#include <memory>
#include <opencv2/imgcodecs.hpp>
#include <stdexcept>
#include <thread>

#include "multicam_egomotion/ros/data_clock.h"
#include "multicam_egomotion/ros/image_conversion.h"
#include "multicam_egomotion/ros/input_queue.h"
#include "multicam_egomotion/ros/topic_watch.h"

namespace multicam_egomotion {
namespace {

constexpr std::chrono::milliseconds kNoWait(0);
constexpr std::int64_t kSecond = 1000000000;

TEST(InputQueue, KeepsOrderDropsOldestImagesAndServesRequestsFirst) {
  InputQueue queue(2, 2);
  for (int i = 0; i < 3; ++i) {
    queue.push(ImageInput{i, nullptr, nullptr, {}});
    queue.push(sensor_msgs::ImuConstPtr());
  }
  int served = 0;
  queue.post([&served] { ++served; });
  EXPECT_EQ(queue.droppedImages(), 1u);
  EXPECT_EQ(queue.droppedImu(), 1u);

  auto input = queue.pop(kNoWait);
  ASSERT_TRUE(input && std::holds_alternative<Request>(*input));
  std::get<Request> (*input)();
  EXPECT_EQ(served, 1);
  for (int camera = 1; camera < 3; ++camera) {
    input = queue.pop(kNoWait);
    ASSERT_TRUE(input && std::holds_alternative<ImageInput>(*input));
    EXPECT_EQ(std::get<ImageInput>(*input).camera, camera);
    input = queue.pop(kNoWait);
    ASSERT_TRUE(input && std::holds_alternative<sensor_msgs::ImuConstPtr>(*input));
  }
  EXPECT_FALSE(queue.pop(kNoWait));
}

TEST(InputQueue, OnceClosedNobodyWaitsForWhatItHeld) {
  InputQueue queue(2, 2);
  const auto answer = std::make_shared<int>(0);
  for (int i = 0; i < 2; ++i) queue.push(ImageInput{});
  queue.post([answer] {});
  EXPECT_EQ(answer.use_count(), 2);
  queue.close();
  EXPECT_EQ(answer.use_count(), 1);
  queue.post([answer] {});
  for (int i = 0; i < 5; ++i) queue.push(ImageInput{});
  EXPECT_EQ(answer.use_count(), 1);
  EXPECT_FALSE(queue.pop(kNoWait));
}

TEST(TopicWatch, NamesSilentTopicsAndMissingPublishers) {
  TopicWatch watch;
  watch.add("/imu", [] { return 1u; });
  watch.add("/cam0/image_raw", [] { return 0u; });
  EXPECT_TRUE(watch.silent().empty());
  watch.note(0);
  std::this_thread::sleep_for(std::chrono::milliseconds(2100));
  EXPECT_EQ(watch.silent(), (std::vector<std::string>{"/imu (2 s)", "/cam0/image_raw (never, no publisher)"}));
  watch.note(1);
  EXPECT_EQ(watch.silent(), (std::vector<std::string>{"/imu (2 s)"}));
}

TEST(DataClock, FollowsTheNewestStampAndJumpsThatAreConfirmed) {
  DataClock clock;
  EXPECT_EQ(clock.advance(100 * kSecond), 100 * kSecond);
  EXPECT_EQ(clock.advance(100 * kSecond - 5), 100 * kSecond);  // late
  EXPECT_EQ(clock.advance(5000 * kSecond), 100 * kSecond);     // one wrong stamp
  EXPECT_EQ(clock.advance(100 * kSecond + 1), 100 * kSecond + 1);
  EXPECT_EQ(clock.advance(20 * kSecond), 100 * kSecond + 1);
  EXPECT_EQ(clock.advance(20 * kSecond + 1), 20 * kSecond + 1);  // a jump back
}

sensor_msgs::Image gradient() {
  sensor_msgs::Image image;
  image.encoding = sensor_msgs::image_encodings::MONO8;
  image.width = 4;
  image.height = 2;
  image.step = 6;
  image.data = {0, 1, 2, 3, 99, 99, 4, 5, 6, 7, 99, 99};
  return image;
}

TEST(ImageConversion, PaddedRowsOwnMemory) {
  sensor_msgs::Image image = gradient();
  const cv::Mat grey = greyPixels(image);
  image.data.assign(image.data.size(), 0);
  ASSERT_EQ(grey.size(), cv::Size(4, 2));
  EXPECT_EQ(grey.at<std::uint8_t>(1, 3), 7);
}

TEST(ImageConversion, FaultsAreNamed) {
  sensor_msgs::Image image = gradient();
  image.data.pop_back();
  EXPECT_THROW(greyPixels(image), std::invalid_argument);
  image = gradient();
  image.step = 3;
  EXPECT_THROW(greyPixels(image), std::invalid_argument);
  image = gradient();
  image.encoding = "mono16";
  image.width = 2;
  image.step = 5;
  EXPECT_THROW(greyPixels(image), std::invalid_argument);
  image = gradient();
  image.encoding = "holographic";
  EXPECT_THROW(greyPixels(image), std::invalid_argument);
  EXPECT_THROW(greyPixels(sensor_msgs::Image()), std::invalid_argument);
  EXPECT_THROW(greyPixels(sensor_msgs::CompressedImage()), std::invalid_argument);
}

TEST(ImageConversion, CompressedImages) {
  cv::Mat pixels(8, 8, CV_8UC1);
  for (int i = 0; i < 64; ++i) pixels.data[i] = static_cast<std::uint8_t>(3 * i);
  sensor_msgs::CompressedImage image;
  image.format = "png";
  cv::imencode(".png", pixels, image.data);
  EXPECT_EQ(cv::norm(greyPixels(image), pixels), 0.0);
  image.data.resize(10);
  EXPECT_THROW(greyPixels(image), std::invalid_argument);
  cv::imencode(".jpg", pixels, image.data);
  EXPECT_LT(cv::norm(greyPixels(image), pixels, cv::NORM_INF), 20.0);
}

// OpenCV's decoder of DICOM, where it has one, ends the process on some of what begins like this.
TEST(ImageConversion, OtherFormatsAreNotDecoded) {
  sensor_msgs::CompressedImage image;
  cv::imencode(".bmp", cv::Mat(8, 8, CV_8UC1, cv::Scalar(9)), image.data);
  EXPECT_THROW(greyPixels(image), std::invalid_argument);
  image.data.assign(128, 4);
  for (const char byte : {'D', 'I', 'C', 'M', '/', '\'', '\1'}) image.data.push_back(static_cast<std::uint8_t>(byte));
  EXPECT_THROW(greyPixels(image), std::invalid_argument);
}

}  // namespace
}  // namespace multicam_egomotion
