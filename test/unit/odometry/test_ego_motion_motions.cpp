// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "multicam_egomotion/geometry/covariance.h"
#include "multicam_egomotion/geometry/so3.h"
#include "scaled_rig.h"
#include "simulated_recording.h"

namespace multicam_egomotion {
namespace {

constexpr double kDegree = M_PI / 180.0;
constexpr double kHeight = 1.5;  // of the body in the room of handheld_stereo [m]

/// The rig and the room of handheld_stereo at half the resolution, on a path of one's own.
Simulator inTheRoom(double duration_s, double image_rate_hz, const Trajectory& trajectory) {
  SimulationOptions options;
  options.duration_s = duration_s;
  options.image_rate_hz = image_rate_hz;
  Scenario scenario = makeScenario("handheld_stereo", options);
  scenario.rig = scaledRig(scenario.rig, 0.5);
  scenario.trajectory = trajectory;
  return Simulator(scenario);
}

struct PathErrors {
  double position = 0.0;   ///< largest [m]
  double rotation = 0.0;   ///< largest, without the tilt that the first frame started with [rad]
  double in_sigmas = 0.0;  ///< largest of a coordinate of the position
  int poses = 0;
};

/// Of poses with the first one on the true one. The tilt that is corrected while it is being found counts as rotation.
PathErrors errorsOf(const std::vector<EgoMotionResult>& results, const Simulator& simulator) {
  PathErrors errors;
  const Eigen::Isometry3d T_world_odom =
      simulator.stateAt(results.front().stamp_ns).T_world_body * results.front().T_odom_body.pose.inverse();
  for (const EgoMotionResult& result : results) {
    if (!result.has_pose) continue;
    EXPECT_TRUE(errors.poses == 0 || isPositiveDefinite(result.T_odom_body.covariance));
    const Eigen::Isometry3d truth = T_world_odom.inverse() * simulator.stateAt(result.stamp_ns).T_world_body;
    const Eigen::Vector3d error = result.T_odom_body.pose.translation() - truth.translation();
    const Eigen::Vector3d sigma = result.T_odom_body.covariance.diagonal().head<3>().cwiseSqrt();
    errors.position = std::max(errors.position, error.norm());
    errors.in_sigmas = std::max(errors.in_sigmas, error.cwiseAbs().cwiseQuotient(sigma).maxCoeff());
    errors.rotation =
        std::max(errors.rotation, logSO3(truth.linear().transpose() * result.T_odom_body.pose.linear()).norm());
    ++errors.poses;
  }
  return errors;
}

PathErrors run(const Simulator& simulator) {
  EgoMotion odometry(simulator.scenario().rig, simulator.scenario().imu, {});
  const Recording recording = recordingOf(simulator);
  const auto results = RecordingPlayer(recording).play(&odometry, 0, recording.frames);
  const PathErrors errors = errorsOf(results, simulator);
  EXPECT_GE(errors.poses, recording.frames - 1);
  return errors;
}

/// At rest for half a second, then a swing of some decimetres and degrees.
MotionJet swing(const TimeJet& t) {
  const TimeJet moving = smoothStep((t - 0.5) * 2.0);
  MotionJet m;
  m.x = moving * (0.3 * sin(t * 2.0));
  m.y = moving * (0.2 * sin(t * 3.0));
  m.z = kHeight + moving * (0.1 * sin(t * 2.5));
  m.yaw = moving * (0.3 * sin(t * 1.5));
  return m;
}

TEST(EgoMotionMotions, TheBodyMayBeMountedAnyWayUp) {
  for (const double roll : {90.0, 180.0}) {
    const Eigen::Matrix3d mounting = expSO3(Eigen::Vector3d(roll * kDegree, 0, 0));
    const PathErrors errors = run(inTheRoom(3.0, 15.0, Trajectory(swing, mounting)));
    EXPECT_LT(errors.position, 0.03) << roll;
    EXPECT_LT(errors.rotation, 1.5 * kDegree) << roll;
    EXPECT_LT(errors.in_sigmas, 4.0) << roll;
  }
}

TEST(EgoMotionMotions, PureRotationIsNoTranslation) {
  const Trajectory turning([](const TimeJet& t) {
    MotionJet m;
    m.z = kHeight;
    m.yaw = smoothStep(t - 0.5) * (0.8 * sin(t * 2.0));
    m.pitch = smoothStep(t - 0.5) * (0.2 * sin(t * 3.0));
    return m;
  });
  const PathErrors errors = run(inTheRoom(4.0, 15.0, turning));
  EXPECT_LT(errors.position, 0.02);
  EXPECT_LT(errors.rotation, 1.5 * kDegree);
}

TEST(EgoMotionMotions, FastRotation) {
  // 400 deg/s at most: some 20 deg between two frames.
  constexpr double kAmplitude = 1.1, kRate = 400.0 * kDegree / kAmplitude;
  const Trajectory shaking([](const TimeJet& t) {
    MotionJet m;
    m.z = kHeight;
    m.yaw = smoothStep(t - 0.5) * (kAmplitude * sin(t * kRate));
    return m;
  });
  const PathErrors errors = run(inTheRoom(4.0, 20.0, shaking));
  EXPECT_LT(errors.position, 0.05);
  EXPECT_LT(errors.rotation, 2.0 * kDegree);
  EXPECT_LT(errors.in_sigmas, 4.0);
}

TEST(EgoMotionMotions, FallingFreelyForMoments) {
  // Up and down once a second, weightless at the top of each.
  constexpr double kRate = 2.0 * M_PI;
  const Trajectory bouncing([](const TimeJet& t) {
    MotionJet m;
    m.z = kHeight + smoothStep((t - 0.5) * 0.5) * (Simulator::kGravity / (kRate * kRate) * sin(t * kRate));
    return m;
  });
  const PathErrors errors = run(inTheRoom(4.0, 15.0, bouncing));
  EXPECT_LT(errors.position, 0.05);
  EXPECT_LT(errors.rotation, 1.5 * kDegree);
  EXPECT_LT(errors.in_sigmas, 4.0);
}

TEST(EgoMotionMotions, AWallWithoutTextureForTwoSeconds) {
  const Simulator simulator = inTheRoom(6.0, 15.0, Trajectory(swing));
  EgoMotion odometry(simulator.scenario().rig, simulator.scenario().imu, {});
  const Recording recording = recordingOf(simulator);
  const auto blank = [&](int frame, std::vector<CameraImage>* images) {
    if (frame < 45 || frame >= 75) return;
    for (CameraImage& image : *images) image.grey = cv::Mat(image.grey.size(), CV_8UC1, cv::Scalar(128));
  };
  const auto results = RecordingPlayer(recording).play(&odometry, 0, recording.frames, blank);
  const PathErrors errors = errorsOf(results, simulator);
  EXPECT_GE(errors.poses, recording.frames - 1);
  EXPECT_LT(errors.in_sigmas, 4.0);
  bool coasting = false;
  for (const EgoMotionResult& result : results) coasting = coasting || result.status == EgoMotionStatus::kCoasting;
  EXPECT_TRUE(coasting);
  EXPECT_EQ(results.back().status, EgoMotionStatus::kTracking);
}

TEST(EgoMotionMotions, AMinuteAtRestInFrontOfAMovingObject) {
  constexpr double kDuration = 60.0, kImageRate = 10.0;
  const Simulator simulator = inTheRoom(kDuration, kImageRate, Trajectory([](const TimeJet&) {
                                          MotionJet m;
                                          m.z = kHeight;
                                          return m;
                                        }));
  const std::vector<CameraImage> still = simulator.renderFrame(0).images;
  const cv::Size size = still[0].grey.size();
  cv::RNG random(1);
  cv::Mat object(size.height, size.width / 2, CV_8UC1);
  random.fill(object, cv::RNG::UNIFORM, 0, 255);
  cv::GaussianBlur(object, object, cv::Size(), 2.0);
  cv::normalize(object, object, 30, 220, cv::NORM_MINMAX);

  Recording recording = recordingOf(simulator);
  recording.images = [&](int frame) {
    std::vector<CameraImage> images = still;
    for (CameraImage& image : images) {
      image.stamp_ns = simulator.frameStamp(frame);
      image.grey = image.grey.clone();
      // Half as wide and as high as the image, to and fro through it, 60 px/s.
      const int x = static_cast<int>(size.width / 4 * (1.0 + std::sin(0.75 * frame / kImageRate)));
      const cv::Rect place(x, size.height / 4, size.width / 2, size.height / 2);
      object(cv::Rect(0, 0, place.width, place.height)).copyTo(image.grey(place));
      cv::Mat noise(size, CV_16SC1);
      random.fill(noise, cv::RNG::NORMAL, 0, 1.5);
      cv::add(image.grey, noise, image.grey, cv::noArray(), CV_8U);
    }
    return images;
  };
  EgoMotion odometry(simulator.scenario().rig, simulator.scenario().imu, {});
  const auto results = RecordingPlayer(recording).play(&odometry, 0, recording.frames);
  const PathErrors errors = errorsOf(results, simulator);
  std::printf("%.1f mm, %.2f deg\n", 1e3 * errors.position, errors.rotation / kDegree);
  EXPECT_GE(errors.poses, recording.frames - 1);
  EXPECT_LE(errors.position, 0.01);
  EXPECT_LE(errors.rotation, 0.2 * kDegree);
}

}  // namespace
}  // namespace multicam_egomotion
