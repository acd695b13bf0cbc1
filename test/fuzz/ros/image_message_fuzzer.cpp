// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
// Any image message, raw or compressed: refused with a message, or grey pixels of its size that the inputs of the
// odometry take or refuse.
#include <stdlib.h>

#include <stdexcept>

#include "../byte_reader.h"
#include "../expect.h"
#include "multicam_egomotion/odometry/sensor_input.h"
#include "multicam_egomotion/ros/image_conversion.h"

namespace multicam_egomotion {
namespace {

constexpr int kWidth = 16, kHeight = 12;

const char* const kEncodings[] = {"mono8", "mono16", "bgr8",        "rgb8",        "bgra8",       "rgba8",
                                  "8UC1",  "16UC1",  "bayer_rggb8", "bayer_bggr8", "bayer_gbrg8", "bayer_grbg8",
                                  "8UC3",  "8UC4",   "32FC1",       "yuv422",      "8UC",         "bayer_rggb16"};

CameraRig smallRig() {
  const CameraModel model(kWidth, kHeight, 20.0, 20.0, 7.5, 5.5, Distortion::kNone, {});
  return CameraRig({{"cam0", "cam0", model, Eigen::Isometry3d::Identity(), 0.0}});
}

/// Small numbers mostly, so that sizes and data fit together now and then.
std::uint32_t dimension(ByteReader* input, std::uint32_t likely) {
  switch (input->choice(4)) {
    case 0:
      return input->take<std::uint32_t>();
    case 1:
      return input->take<std::uint8_t>();
    default:
      return likely;
  }
}

sensor_msgs::Image takeImage(ByteReader* input) {
  sensor_msgs::Image image;
  const int known = input->choice(std::size(kEncodings) + 1);
  if (known < static_cast<int>(std::size(kEncodings))) {
    image.encoding = kEncodings[known];
  } else {
    const std::vector<std::uint8_t> name = input->bytes(input->choice(24));
    image.encoding.assign(name.begin(), name.end());
  }
  image.width = dimension(input, kWidth);
  image.height = dimension(input, kHeight);
  image.step = dimension(input, image.width * static_cast<std::uint32_t>(1 + input->choice(4)));
  image.is_bigendian = input->choice(8) == 0;
  if (input->choice(2) == 0) {
    image.data = input->bytes(input->left());
  } else {
    const std::uint8_t grey = input->take<std::uint8_t>();
    image.data.assign(std::min<std::size_t>(static_cast<std::size_t>(image.step) * image.height, 1 << 16), grey);
  }
  return image;
}

/// The same picture four times: frozen in the end.
void feed(const cv::Mat& grey) {
  static const CameraRig rig = smallRig();
  EgoMotionOptions options;
  options.use_imu = false;
  SensorInput sensors(rig, ImuCalibration(), options);
  for (std::int64_t stamp_ns = 50000000; stamp_ns <= 200000000; stamp_ns += 50000000) {
    sensors.addImage({0, stamp_ns, grey}, stamp_ns);
    sensors.advance(stamp_ns);
    while (std::optional<FrameSet> set = sensors.next()) {
      expect(set->images.size() == 1 && set->images[0].grey.size() == cv::Size(kWidth, kHeight), "images that fit");
      sensors.takeOutFrozen(ExpectedMotion(), &*set);
    }
    sensors.faults();
  }
}

void useInput(ByteReader input) {
  try {
    if (input.choice(4) == 0) {
      sensor_msgs::CompressedImage image;
      image.data = input.bytes(input.left());
      feed(greyPixels(image));
      return;
    }
    const sensor_msgs::Image image = takeImage(&input);
    const cv::Mat grey = greyPixels(image);
    expect(grey.type() == CV_8UC1 && grey.cols == static_cast<int>(image.width) &&
               grey.rows == static_cast<int>(image.height),
           "grey pixels of the message's size");
    feed(grey);
  } catch (const std::invalid_argument& error) {
    expect(error.what()[0] != '\0', "a message");
  }
}

}  // namespace
}  // namespace multicam_egomotion

extern "C" int LLVMFuzzerInitialize(int*, char***) {
  setenv("OPENCV_IO_MAX_IMAGE_PIXELS", "1048576", 1);  // a header may claim any size; memory is not what is tested here
  setenv("OPENCV_LOG_LEVEL", "SILENT", 1);
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  multicam_egomotion::useInput({data, size});
  return 0;
}
