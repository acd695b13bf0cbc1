// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
// Any sequence of IMU samples, images and calls through the odometry: what comes out is finite, covariances included.
#include <cmath>
#include <limits>
#include <memory>

#include "byte_reader.h"
#include "expect.h"
#include "multicam_egomotion/odometry/ego_motion.h"

namespace multicam_egomotion {
namespace {

constexpr std::int64_t kStart = 1600000000000000000;
constexpr int kWidth = 64, kHeight = 48;
constexpr int kMaxImages = 24;  // an input is to end in time

const double kSpecial[] = {0.0,
                           -0.0,
                           1.0,
                           9.81,
                           -9.81,
                           35.0,
                           1e3,
                           1e10,
                           -1e100,
                           std::numeric_limits<double>::max(),
                           std::numeric_limits<double>::denorm_min(),
                           std::numeric_limits<double>::infinity(),
                           -std::numeric_limits<double>::infinity(),
                           std::numeric_limits<double>::quiet_NaN()};
const std::int64_t kSteps[] = {0,        1,          1000,       1000000,       5000000,        50000000,
                               -5000000, -300000000, 1500000000, 7000000000,    -10000000000,   3600000000000,
                               100000,   20000000,   200000000,  -100000000000, 10000000000000, 49999999};

RigCamera camera(int index, double y) {
  Eigen::Isometry3d T_body_cam = Eigen::Isometry3d::Identity();
  T_body_cam.linear() << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  T_body_cam.translation() << 0.1, y, 0.0;
  const std::string name = "cam" + std::to_string(index);
  return {name, name, CameraModel(kWidth, kHeight, 55.0, 55.0, 31.5, 23.5, Distortion::kNone, {}), T_body_cam, 0.0};
}

/// A textured plane seen from somewhere else every time; the same texture for the same `x`, `y`.
cv::Mat texture(int width, int height, int x, int y) {
  cv::Mat image(height, width, CV_8UC1);
  for (int row = 0; row < height; ++row) {
    for (int column = 0; column < width; ++column) {
      const unsigned cell =
          static_cast<unsigned>((column + x) / 7) * 73856093u ^ static_cast<unsigned>((row + y) / 6) * 19349663u;
      image.at<std::uint8_t>(row, column) = static_cast<std::uint8_t>((cell * 2654435761u) >> 24);
    }
  }
  return image;
}

bool finite(const PoseWithCovariance& pose) { return pose.pose.matrix().allFinite() && pose.covariance.allFinite(); }

void expectSound(const EgoMotionResult& result) {
  if (result.has_pose) {
    expect(finite(result.T_odom_body), "a finite pose");
    const Matrix6d& covariance = result.T_odom_body.covariance;
    expect((covariance.diagonal().array() >= 0.0).all(), "no negative variance");
    const Eigen::Matrix3d R = result.T_odom_body.pose.linear();
    expect((R * R.transpose() - Eigen::Matrix3d::Identity()).norm() < 1e-6, "a rotation");
    expect(result.twist.linear.allFinite() && result.twist.angular.allFinite() && result.twist.covariance.allFinite(),
           "a finite twist");
    expect(result.gyroscope_bias.allFinite() && result.accelerometer_bias.allFinite(), "finite biases");
  }
  if (result.has_relative_pose) expect(finite(result.T_previous_body), "a finite relative pose");
}

class Session {
 public:
  explicit Session(ByteReader* input) : input_(*input) {
    EgoMotionOptions options;
    const int flags = input_.take<std::uint8_t>();
    options.use_imu = (flags & 3) != 3;
    options.imu_orientation = flags & 4 ? "message" : "filter";
    options.on_time_jump = flags & 8 ? "continue" : "reset";
    options.solver = flags & 16 ? "4pt-axis" : "auto";
    cameras_ = flags & 32 ? 1 : 2;
    options.assembler.min_cameras = flags & 64 ? cameras_ : 1;
    options.tracker.features_per_camera = 20;
    options.tracker.min_distance_px = 5;
    options.tracker.pyramid_levels = 2;
    options.ransac.max_samples = 20;
    options.ransac.min_samples = 5;
    options.window.max_keyframes = 3;
    options.window.bundle.max_iterations = 3;
    std::vector<RigCamera> rig = {camera(0, 0.05)};
    if (cameras_ == 2) rig.push_back(camera(1, -0.05));
    odometry_ = std::make_unique<EgoMotion>(CameraRig(rig), ImuCalibration(), options);
  }

  void run() {
    while (input_.left() > 0) act();
    check(odometry_->finish());
    look();
  }

 private:
  void act() {
    switch (input_.choice(12)) {
      case 0:
      case 1:
      case 2:
        return standardPeriod();
      case 3:
        return strangeImu();
      case 4:
        return strangeImage();
      case 5:
        now_ns_ += step();
        return;
      case 6:
        now_ns_ = input_.take<std::int64_t>();
        return;
      case 7:
        return check(odometry_->advance(now_ns_));
      case 8:
        odometry_->reset(input_.choice(2) == 1);
        return;
      case 9:
        odometry_->setPose(Eigen::Isometry3d(Eigen::Translation3d(input_.choice(100), -3.0, 1.0)));
        return;
      case 10:
        return look();
      default:
        velocity_ = input_.take<std::int8_t>();
        return;
    }
  }

  /// 50 ms as they should be: ten IMU samples and an image of each camera.
  void standardPeriod() {
    for (int i = 0; i < 10; ++i) {
      ImuSample sample;
      sample.stamp_ns = advancedBy(5000000);
      sample.angular_velocity << 0.001 * (i % 3), 0.0, 0.01 * velocity_;
      sample.linear_acceleration << 0.01 * i, 0.0, 9.81;
      add(sample);
    }
    x_ += velocity_ / 8;
    for (int i = 0; i < cameras_; ++i) addImage({i, now_ns_, texture(kWidth, kHeight, 1000000 + x_ + 3 * i, 0)});
    check(odometry_->advance(now_ns_));
  }

  void strangeImu() {
    ImuSample sample;
    sample.stamp_ns = stamp();
    for (int axis = 0; axis < 3; ++axis) sample.angular_velocity[axis] = value();
    for (int axis = 0; axis < 3; ++axis) sample.linear_acceleration[axis] = value();
    if (input_.choice(2) == 1) {
      for (int i = 0; i < 4; ++i) sample.orientation_xyzw[i] = value();
      sample.orientation_sigma = value();
    }
    add(sample);
  }

  void strangeImage() {
    CameraImage image;
    image.camera = input_.choice(4) - 1;
    image.stamp_ns = stamp();
    const int grey = input_.take<std::uint8_t>();
    switch (input_.choice(6)) {
      case 0:
        break;
      case 1:
        image.grey = cv::Mat(kHeight, kWidth, CV_8UC1, cv::Scalar(grey));
        break;
      case 2:
        image.grey = texture(1 + grey, 1 + input_.choice(256), 0, 0);
        break;
      case 3:
        image.grey = cv::Mat(kHeight, kWidth, grey % 2 == 0 ? CV_16UC1 : CV_8UC3, cv::Scalar::all(grey));
        break;
      default:
        image.grey = texture(kWidth, kHeight, grey, grey / 2);
    }
    addImage(image);
  }

  void add(const ImuSample& sample) {
    odometry_->addImu(sample);
    check(odometry_->advance(now_ns_));
  }

  void addImage(const CameraImage& image) {
    if (++images_ <= kMaxImages) odometry_->addImage(image, now_ns_);
  }

  void look() {
    if (const auto ahead = odometry_->predictToLatestImu()) expectSound(*ahead);
    odometry_->counters();
    odometry_->faults();
    odometry_->gyroscopeCheck();
  }

  void check(const std::vector<EgoMotionResult>& results) {
    for (const EgoMotionResult& result : results) expectSound(result);
  }

  std::int64_t step() { return kSteps[input_.choice(std::size(kSteps))]; }

  std::int64_t advancedBy(std::int64_t step_ns) {
    if (now_ns_ > 0 && now_ns_ < 2 * kStart) return now_ns_ += step_ns;
    return now_ns_ = kStart;
  }

  std::int64_t stamp() {
    switch (input_.choice(4)) {
      case 0:
        return advancedBy(5000000);
      case 1:
        return advancedBy(0) + step();
      case 2:
        return advancedBy(step());
      default:
        return input_.take<std::int64_t>();
    }
  }

  double value() {
    const int kind = input_.choice(24);
    if (kind < static_cast<int>(std::size(kSpecial))) return kSpecial[kind];
    return kind < 22 ? 0.1 * input_.take<std::int8_t>() : input_.take<double>();
  }

  ByteReader& input_;
  std::unique_ptr<EgoMotion> odometry_;
  int cameras_, images_ = 0;
  std::int64_t now_ns_ = kStart;
  int velocity_ = 8, x_ = 0;
};

}  // namespace
}  // namespace multicam_egomotion

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  multicam_egomotion::ByteReader input(data, size);
  multicam_egomotion::Session(&input).run();
  return 0;
}
