// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <rosbag/bag.h>
#include <rosbag/view.h>
#include <std_msgs/String.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <map>
#include <opencv2/imgcodecs.hpp>
#include <sstream>
#include <stdexcept>

#include "fault_injection/corrupted_bag.h"

namespace multicam_egomotion {
namespace {

namespace fs = std::filesystem;

constexpr int kWidth = 32, kHeight = 24;
const ros::Time kBegin(100.0);

std_msgs::Header header(double time_s, const std::string& frame) {
  std_msgs::Header header;
  header.stamp = kBegin + ros::Duration(time_s);
  header.frame_id = frame;
  return header;
}

/// Ten images a second of two cameras, a hundred IMU samples, 4 s; CameraInfo and a message of another kind.
void writeRecording(const std::string& path) {
  rosbag::Bag bag(path, rosbag::bagmode::Write);
  std_msgs::String text;
  text.data = "kept";
  bag.write("/note", kBegin, text);
  for (int i = 0; i <= 400; ++i) {
    sensor_msgs::Imu imu;
    imu.header = header(0.01 * i, "imu");
    imu.orientation_covariance[0] = -1.0;
    imu.angular_velocity.x = 0.5;
    imu.angular_velocity.y = 0.001 * i;
    imu.linear_acceleration.z = 9.80665;
    bag.write("/imu", imu.header.stamp, imu);
    if (i % 10 != 0) continue;
    for (const std::string camera : {"cam0", "cam1"}) {
      sensor_msgs::Image image;
      image.header = header(0.01 * i, camera);
      image.encoding = "mono8";
      image.width = image.step = kWidth;
      image.height = kHeight;
      for (int k = 0; k < kWidth * kHeight; ++k) image.data.push_back(static_cast<std::uint8_t>((k + i) % 200));
      sensor_msgs::CameraInfo info;
      info.header = image.header;
      info.width = kWidth;
      info.height = kHeight;
      info.K = {30, 0, 16, 0, 30, 12, 0, 0, 1};
      bag.write("/" + camera + "/image_raw", image.header.stamp, image);
      bag.write("/" + camera + "/camera_info", image.header.stamp, info);
    }
  }
  bag.close();
}

/// Messages of a bag by topic, in the order of arrival.
struct Contents {
  std::map<std::string, std::vector<sensor_msgs::ImageConstPtr>> images;
  std::map<std::string, std::vector<sensor_msgs::CameraInfoConstPtr>> infos;
  std::vector<sensor_msgs::ImuConstPtr> imu;
  std::vector<ros::Time> arrivals;  ///< of all messages
  int others = 0;

  explicit Contents(const std::string& path) {
    rosbag::Bag bag(path, rosbag::bagmode::Read);
    rosbag::View view(bag);
    for (const rosbag::MessageInstance& message : view) {
      arrivals.push_back(message.getTime());
      if (const auto image = message.instantiate<sensor_msgs::Image>()) {
        images[message.getTopic()].push_back(image);
      } else if (const auto info = message.instantiate<sensor_msgs::CameraInfo>()) {
        infos[message.getTopic()].push_back(info);
      } else if (const auto sample = message.instantiate<sensor_msgs::Imu>()) {
        imu.push_back(sample);
      } else {
        ++others;
      }
    }
  }
  const std::vector<sensor_msgs::ImageConstPtr>& cam(int index) const {
    return images.at("/cam" + std::to_string(index) + "/image_raw");
  }
  const std::vector<sensor_msgs::CameraInfoConstPtr>& info(int index) const {
    return infos.at("/cam" + std::to_string(index) + "/camera_info");
  }
};

double timeOf(const std_msgs::Header& header) { return (header.stamp - kBegin).toSec(); }

class CorruptBag : public testing::Test {
 protected:
  static void SetUpTestSuite() { writeRecording(input()); }
  static void TearDownTestSuite() { fs::remove(input()); }
  static std::string input() { return path("input"); }
  static std::string path(const std::string& name) {
    return testing::TempDir() + "corrupt_bag_" + name + "_" + std::to_string(::getpid()) + ".bag";
  }
  static Contents corrupted(const std::vector<std::string>& faults, std::uint64_t seed = 1) {
    std::vector<FaultRequest> requests;
    for (const std::string& fault : faults) requests.push_back(parseFault(fault));
    corruptBag(input(), path("output"), requests, seed);
    const Contents contents(path("output"));
    fs::remove(path("output"));
    return contents;
  }
  /// Exit code of the program; what it printed.
  static int run(const std::string& arguments, std::string* printed) {
    FILE* pipe = ::popen((std::string(CORRUPT_BAG) + " " + arguments + " 2>&1").c_str(), "r");
    char buffer[256];
    printed->clear();
    while (std::fgets(buffer, sizeof(buffer), pipe) != nullptr) *printed += buffer;
    return WEXITSTATUS(::pclose(pipe));
  }
};

TEST_F(CorruptBag, WithoutEffectEverythingIsKept) {
  const Contents contents = corrupted({"camera_lost:from=50,to=60"});
  EXPECT_EQ(contents.cam(0).size(), 41u);
  EXPECT_EQ(contents.cam(1).size(), 41u);
  EXPECT_EQ(contents.info(1).size(), 41u);
  EXPECT_EQ(contents.imu.size(), 401u);
  EXPECT_EQ(contents.others, 1);
}

TEST_F(CorruptBag, EveryFaultChangesTheBagAndIsRepeatable) {
  const Contents original(input());
  const auto fingerprint = [](const Contents& contents) {
    std::ostringstream text;
    for (const auto& [topic, images] : contents.images) {
      for (const auto& image : images) text << topic << *image;
    }
    for (const auto& [topic, infos] : contents.infos) {
      for (const auto& info : infos) text << topic << *info;
    }
    for (const auto& sample : contents.imu) text << *sample;
    for (const ros::Time& arrival : contents.arrivals) text << arrival;
    return std::hash<std::string>()(text.str());
  };
  for (const FaultKind& kind : faultKinds()) {
    const std::size_t once = fingerprint(corrupted({kind.name})), again = fingerprint(corrupted({kind.name}));
    EXPECT_NE(once, fingerprint(original)) << kind.name;
    EXPECT_EQ(once, again) << kind.name;
  }
  EXPECT_NE(fingerprint(corrupted({"image_noise"}, 1)), fingerprint(corrupted({"image_noise"}, 2)));
}

TEST_F(CorruptBag, Stamps) {
  Contents contents = corrupted({"time_jump:at=2,by=-1.5"});
  EXPECT_NEAR(timeOf(contents.cam(0)[19]->header), 1.9, 1e-6);
  EXPECT_NEAR(timeOf(contents.cam(0)[20]->header), 0.5, 1e-6);
  EXPECT_NEAR(timeOf(contents.imu[200]->header), 0.5, 1e-6);

  contents = corrupted({"clock_offset:camera=1,offset=0.03"});
  EXPECT_NEAR(timeOf(contents.cam(0)[5]->header), 0.5, 1e-6);
  EXPECT_NEAR(timeOf(contents.cam(1)[5]->header), 0.53, 1e-6);

  contents = corrupted({"zero_stamps:of=imu,every=2,from=1,to=2"});
  int zero = 0;
  for (const auto& sample : contents.imu) zero += sample->header.stamp.isZero();
  EXPECT_EQ(zero, 50);
  for (const auto& image : contents.cam(0)) EXPECT_FALSE(image->header.stamp.isZero());

  EXPECT_THROW(corrupted({"time_jump:at=2,by=-1000"}), std::runtime_error);
}

TEST_F(CorruptBag, OrderOfArrival) {
  Contents contents = corrupted({"duplicate_images:camera=1,every=4"});
  EXPECT_EQ(contents.cam(0).size(), 41u);
  EXPECT_EQ(contents.cam(1).size(), 52u);

  contents = corrupted({"out_of_order_imu:every=10,delay=0.015"});
  int back = 0;
  for (std::size_t i = 1; i < contents.imu.size(); ++i) {
    back += contents.imu[i]->header.stamp < contents.imu[i - 1]->header.stamp;
  }
  EXPECT_EQ(back, 40);

  contents = corrupted({"bag_loop:times=3"});
  ASSERT_EQ(contents.imu.size(), 3u * 401u);
  EXPECT_EQ(contents.imu[401]->header.stamp, contents.imu[0]->header.stamp);
  EXPECT_EQ(contents.others, 3);
}

TEST_F(CorruptBag, LossesAreOfTheCameraAndTimeChosen) {
  Contents contents = corrupted({"camera_lost:camera=1,from=1,to=2"});
  EXPECT_EQ(contents.cam(0).size(), 41u);
  EXPECT_EQ(contents.cam(1).size(), 31u);
  EXPECT_EQ(contents.info(1).size(), 31u);
  for (const auto& image : contents.cam(1)) {
    EXPECT_FALSE(timeOf(image->header) > 0.999 && timeOf(image->header) < 1.999);
  }
  EXPECT_EQ(corrupted({"imu_gap:from=1,to=1.5"}).imu.size(), 351u);
  EXPECT_EQ(corrupted({"imu_silent:from=1"}).imu.size(), 100u);
  EXPECT_EQ(corrupted({"imu_rate:rate=10"}).imu.size(), 41u);
  contents = corrupted({"time_gap:from=1,to=2"});
  EXPECT_EQ(contents.imu.size(), 301u);
  EXPECT_EQ(contents.cam(0).size(), 31u);
  EXPECT_EQ(corrupted({"camera_info_absent:camera=0"}).infos.count("/cam0/camera_info"), 0u);
}

TEST_F(CorruptBag, Pictures) {
  const Contents original(input());
  const auto pixelAt = [](const sensor_msgs::ImageConstPtr& image, int x, int y) {
    return static_cast<int>(image->data[y * image->step + x]);
  };
  const auto first = original.cam(0)[10];
  EXPECT_EQ(pixelAt(corrupted({"image_blank:from=1,to=2,grey=77"}).cam(0)[10], 3, 3), 77);
  EXPECT_EQ(pixelAt(corrupted({"image_dark:from=1,to=2,factor=0"}).cam(0)[10], 3, 3), 0);
  EXPECT_EQ(pixelAt(corrupted({"image_saturated:from=1,to=2,factor=1000"}).cam(0)[10], 3, 3), 255);
  EXPECT_EQ(pixelAt(corrupted({"exposure_steps:from=1,to=3,factor=0,period=0.5"}).cam(0)[12], 3, 3), 0);
  EXPECT_EQ(pixelAt(corrupted({"exposure_steps:from=1,to=3,factor=0,period=0.5"}).cam(0)[17], 3, 3),
            pixelAt(original.cam(0)[17], 3, 3));

  const auto covered = corrupted({"obstruction:camera=0,from=1,to=2,width=0.5,grey=9"}).cam(0)[10];
  EXPECT_EQ(pixelAt(covered, kWidth / 2 - 1, 5), 9);
  EXPECT_EQ(pixelAt(covered, kWidth / 2, 5), pixelAt(first, kWidth / 2, 5));

  const Contents frozen = corrupted({"image_frozen:from=1,to=2"});
  EXPECT_EQ(frozen.cam(1)[19]->data, original.cam(1)[10]->data);
  EXPECT_EQ(frozen.cam(1)[19]->header.stamp, original.cam(1)[19]->header.stamp);
  EXPECT_EQ(frozen.cam(1)[20]->data, original.cam(1)[20]->data);

  const auto small = corrupted({"image_size:camera=1,scale=0.5,from=1,to=2"}).cam(1)[10];
  EXPECT_EQ(small->width, kWidth / 2u);
  EXPECT_EQ(small->data.size(), small->step * small->height);
  EXPECT_EQ(corrupted({"image_truncated:camera=1,keep=0.25,from=1,to=2"}).cam(1)[10]->data.size(),
            kWidth * kHeight / 4u);

  const auto coloured = corrupted({"image_encoding:encoding=bgr8,from=1,to=2"}).cam(0)[10];
  EXPECT_EQ(coloured->encoding, "bgr8");
  EXPECT_EQ(coloured->step, 3u * kWidth);
  EXPECT_EQ(corrupted({"image_encoding:encoding=unknown,from=1,to=2"}).cam(0)[10]->encoding, "unknown");

  double sum = 0.0, squares = 0.0;
  const auto noisy = corrupted({"image_noise:from=1,to=2,sigma=5"}).cam(0)[10];
  int n = 0;
  for (std::size_t i = 0; i < noisy->data.size(); ++i) {
    if (first->data[i] < 20) continue;  // cut at black
    const double difference = static_cast<double>(noisy->data[i]) - first->data[i];
    sum += difference;
    squares += difference * difference;
    ++n;
  }
  EXPECT_NEAR(sum / n, 0.0, 1.0);
  EXPECT_NEAR(std::sqrt(squares / n), 5.0, 0.7);

  // The object covers half the width and has left nothing where it is not.
  const auto crossed = corrupted({"moving_object:camera=0,size=0.5,speed=16,from=0,to=3"}).cam(0)[10];
  EXPECT_NE(std::vector<std::uint8_t>(crossed->data.begin() + 12 * kWidth, crossed->data.begin() + 12 * kWidth + 16),
            std::vector<std::uint8_t>(first->data.begin() + 12 * kWidth, first->data.begin() + 12 * kWidth + 16));
  EXPECT_EQ(pixelAt(crossed, kWidth - 1, 12), pixelAt(first, kWidth - 1, 12));
}

TEST_F(CorruptBag, CompressedAnd16BitPictures) {
  const std::string recording = path("compressed"), output = path("output");
  const cv::Mat grey(kHeight, kWidth, CV_8UC1, cv::Scalar(50)), deep(kHeight, kWidth, CV_16UC1, cv::Scalar(1000));
  {
    rosbag::Bag bag(recording, rosbag::bagmode::Write);
    sensor_msgs::CompressedImage compressed;
    compressed.header = header(0.0, "cam0");
    compressed.format = "mono8; png compressed";
    cv::imencode(".png", grey, compressed.data);
    bag.write("/cam0/image_raw/compressed", compressed.header.stamp, compressed);
    sensor_msgs::Image raw;
    raw.header = header(0.0, "cam1");
    raw.encoding = "mono16";
    raw.width = kWidth;
    raw.height = kHeight;
    raw.step = 2 * kWidth;
    raw.data.assign(deep.datastart, deep.dataend);
    bag.write("/cam1/image_raw", raw.header.stamp, raw);
  }
  corruptBag(recording, output, {parseFault("image_saturated:factor=4,from=0,to=1")}, 1);
  {
    rosbag::Bag bag(output, rosbag::bagmode::Read);
    rosbag::View view(bag);
    EXPECT_EQ(view.size(), 2u);
    for (const rosbag::MessageInstance& message : view) {
      if (const auto compressed = message.instantiate<sensor_msgs::CompressedImage>()) {
        EXPECT_EQ(cv::norm(cv::imdecode(compressed->data, cv::IMREAD_UNCHANGED), 4 * grey, cv::NORM_INF), 0.0);
      } else {
        const auto raw = message.instantiate<sensor_msgs::Image>();
        EXPECT_EQ(*reinterpret_cast<const std::uint16_t*>(raw->data.data()), 4000);
      }
    }
  }
  fs::remove(recording);
  fs::remove(output);
}

TEST_F(CorruptBag, CameraInfos) {
  EXPECT_EQ(corrupted({"camera_info_zero:camera=1"}).info(1)[0]->K[0], 0.0);
  const auto info = corrupted({"camera_info_mismatch:camera=1,scale=0.5"}).info(1)[0];
  EXPECT_EQ(info->width, kWidth / 2u);
  EXPECT_EQ(info->K[0], 15.0);
  EXPECT_EQ(info->K[8], 1.0);
  const Contents shared = corrupted({"shared_frame_id"});
  EXPECT_EQ(shared.info(1)[3]->header.frame_id, shared.info(0)[3]->header.frame_id);
  EXPECT_EQ(shared.cam(1)[3]->header.frame_id, shared.info(0)[3]->header.frame_id);
}

TEST_F(CorruptBag, ImuValues) {
  EXPECT_NEAR(corrupted({"imu_g_units"}).imu[7]->linear_acceleration.z, 1.0, 1e-12);
  EXPECT_EQ(corrupted({"imu_swapped_axes:axes=xy,sensor=gyroscope"}).imu[7]->angular_velocity.y, 0.5);
  EXPECT_EQ(corrupted({"imu_swapped_axes:axes=yz,sensor=gyroscope"}).imu[7]->linear_acceleration.z, 9.80665);
  EXPECT_NEAR(corrupted({"imu_bias:gyroscope=0.25"}).imu[7]->angular_velocity.x, 0.75, 1e-12);
  EXPECT_EQ(corrupted({"imu_saturated:gyroscope=0.2,from=0,to=1"}).imu[7]->angular_velocity.x, 0.2);
  const Contents nan = corrupted({"imu_nan:every=2,from=1,to=2"});
  int bad = 0;
  for (const auto& sample : nan.imu) bad += std::isnan(sample->angular_velocity.x);
  EXPECT_EQ(bad, 50);
  const Contents frozen = corrupted({"imu_frozen:from=1,to=2"});
  EXPECT_EQ(frozen.imu[199]->angular_velocity.y, 0.1);
  EXPECT_NEAR(timeOf(frozen.imu[199]->header), 1.99, 1e-6);
  EXPECT_EQ(corrupted({"imu_orientation"}).imu[7]->orientation.w, 1.0);
  EXPECT_EQ(corrupted({"imu_orientation"}).imu[7]->orientation_covariance[0], 0.0);
}

TEST_F(CorruptBag, FaultsWorkOneAfterTheOther) {
  const Contents contents =
      corrupted({"time_jump:at=0,by=50", "camera_lost:camera=0,from=1,to=2", "image_blank:grey=3"});
  EXPECT_EQ(contents.cam(0).size(), 31u);
  EXPECT_NEAR(timeOf(contents.cam(0)[0]->header), 50.0, 1e-6);
  EXPECT_EQ(contents.cam(1)[35]->data[0], 3);
}

TEST_F(CorruptBag, WrongNamesAndValuesAreNamed) {
  const auto refusal = [](const std::string& fault) -> std::string {
    try {
      corrupted({fault});
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_NE(refusal("camera_gone").find("expected one of time_jump"), std::string::npos);
  EXPECT_NE(refusal("camera_lost:lens=1").find("expected one of camera, from, to"), std::string::npos);
  EXPECT_NE(refusal("camera_lost:camera").find("expected name=value"), std::string::npos);
  EXPECT_NE(refusal("camera_lost:camera=0.5").find("expected a whole number from -1 to 7"), std::string::npos);
  EXPECT_NE(refusal("camera_lost:camera=2").find("expected less than 2"), std::string::npos);
  EXPECT_NE(refusal("camera_lost:from=later").find("from is 'later', expected a number"), std::string::npos);
  EXPECT_NE(refusal("camera_lost:from=nan").find("expected a number"), std::string::npos);
  EXPECT_NE(refusal("camera_lost:from=3,to=2").find("expected less than to"), std::string::npos);
  EXPECT_NE(refusal("imu_nan:sensor=compass").find("expected one of both, gyroscope"), std::string::npos);
}

TEST_F(CorruptBag, TheProgramListsAndRefuses) {
  std::string printed;
  EXPECT_EQ(run("--list", &printed), 0);
  EXPECT_NE(printed.find("camera_lost  camera=1 [index, -1: all]  from=3 [s]  to=5 [s]"), std::string::npos) << printed;
  EXPECT_EQ(static_cast<std::size_t>(std::count(printed.begin(), printed.end(), '\n')), faultKinds().size());
  EXPECT_EQ(run("--help", &printed), 0);

  EXPECT_EQ(run(input() + " " + path("program") + " --fault camera_lost:camera=1,from=1,to=2 --seed 3", &printed), 0);
  EXPECT_EQ(Contents(path("program")).cam(1).size(), 31u);
  fs::remove(path("program"));

  EXPECT_EQ(run(input() + " " + path("program") + " --fault nothing", &printed), 2);
  EXPECT_NE(printed.find("corrupt_bag: found fault 'nothing'"), std::string::npos) << printed;
  EXPECT_FALSE(fs::exists(path("program")));
  EXPECT_EQ(run(input() + " " + path("program") + " --fault camera_lost:camera=5", &printed), 2);
  EXPECT_EQ(run(input() + " " + path("program"), &printed), 2);
  EXPECT_EQ(run(input() + " " + input() + " --fault imu_nan", &printed), 2);
  EXPECT_EQ(run(input() + " " + path("program") + " --speed 2", &printed), 2);
  EXPECT_EQ(run(path("absent") + " " + path("program") + " --fault imu_nan", &printed), 1);
}

}  // namespace
}  // namespace multicam_egomotion
