// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
// Starts in the middle of a motion, images and IMU from the same moment on.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <utility>

#include "euroc_excerpt.h"
#include "scaled_rig.h"
#include "simulator/simulator.h"

namespace multicam_egomotion {
namespace {

constexpr double kDegree = M_PI / 180.0;
constexpr double kSpan = 2.0;         // in which the vertical is to be found [s]
constexpr double kLeastSpeed = 0.05;  // of a start in motion [m/s]

struct MovingRecording {
  std::string name;
  CameraRig rig;
  ImuCalibration imu;
  Recording recording;
  std::function<Eigen::Isometry3d(std::int64_t stamp_ns)> truth;
};

MovingRecording simulatedRecording(const std::string& name) {
  Scenario scenario = makeScenario(name);
  scenario.rig = scaledRig(scenario.rig, 0.5);
  const auto simulator = std::make_shared<Simulator>(scenario);
  MovingRecording moving{name, scenario.rig, scenario.imu, {}, {}};
  moving.recording.imu = simulator->imuSamples();
  moving.recording.frames = simulator->frames();
  moving.recording.images = [simulator](int frame) { return simulator->renderFrame(frame).images; };
  moving.recording.stamp = [simulator](int frame) { return simulator->frameStamp(frame); };
  moving.truth = [simulator](std::int64_t stamp_ns) { return simulator->stateAt(stamp_ns).T_world_body; };
  return moving;
}

std::vector<MovingRecording> recordings() {
  std::vector<MovingRecording> all;
  for (const char* name : {"handheld_stereo", "drone_fisheye", "car_surround"}) {
    all.push_back(simulatedRecording(name));
  }
  if (std::optional<EurocExcerpt> euroc = eurocExcerpt()) {
    const auto truth = [poses = euroc->truth](std::int64_t stamp_ns) { return poseAt(poses, stamp_ns); };
    all.push_back({"euroc_mh01_excerpt", euroc->rig, euroc->imu, euroc->recording, truth});
  }
  return all;
}

double speedAt(const MovingRecording& moving, int frame) {
  const std::int64_t before = moving.recording.stamp(frame), after = moving.recording.stamp(frame + 1);
  return (moving.truth(after).translation() - moving.truth(before).translation()).norm() /
         (1e-9 * static_cast<double>(after - before));
}

int framesIn(const Recording& recording, double seconds) {
  return static_cast<int>(std::lround(1e9 * seconds / (recording.stamp(1) - recording.stamp(0))));
}

EgoMotionResult resultAfter(const MovingRecording& moving, int first, int frames) {
  Recording from_there = moving.recording;
  const std::int64_t begin_ns = moving.recording.stamp(first);
  from_there.imu.erase(from_there.imu.begin(),
                       std::lower_bound(from_there.imu.begin(), from_there.imu.end(), begin_ns,
                                        [](const ImuSample& one, std::int64_t ns) { return one.stamp_ns < ns; }));
  EgoMotion odometry(moving.rig, moving.imu, {});
  return RecordingPlayer(from_there).play(&odometry, first, first + frames + 1).back();
}

TEST(EgoMotionStarts, TwentyInMotionFindTheVerticalInTwoSeconds) {
  constexpr int kStarts = 20;
  const std::vector<MovingRecording> all = recordings();
  std::mt19937 random(1);
  std::vector<double> errors;
  int within = 0;
  while (errors.size() < kStarts) {
    const MovingRecording& moving = all[errors.size() % all.size()];
    const int frames = framesIn(moving.recording, kSpan);
    const int first = std::uniform_int_distribution<int>(0, moving.recording.frames - frames - 2)(random);
    if (speedAt(moving, first) < kLeastSpeed) continue;
    const EgoMotionResult result = resultAfter(moving, first, frames);
    ASSERT_TRUE(result.has_pose) << moving.name << " from frame " << first;
    const Eigen::Vector3d up = moving.truth(result.stamp_ns).linear().row(2).transpose();
    const double error = std::acos(std::min(1.0, (result.T_odom_body.pose.linear() * up).z()));
    const double sigma =
        std::sqrt(Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(result.T_odom_body.covariance.block<2, 2>(3, 3))
                      .eigenvalues()[1]);
    within += error < 3.0 * sigma;
    errors.push_back(error / kDegree);
    std::printf("%s from frame %d: tilt error %.2f deg, sigma %.2f deg\n", moving.name.c_str(), first, errors.back(),
                sigma / kDegree);
  }
  std::sort(errors.begin(), errors.end());
  std::printf("median %.2f deg, worst %.2f deg, %d of %d within 3 sigma\n", errors[kStarts / 2], errors.back(), within,
              kStarts);
  EXPECT_LE(errors[kStarts / 2], 1.0);
  EXPECT_LE(errors.back(), 2.5);
  EXPECT_GE(within, 18);
}

}  // namespace
}  // namespace multicam_egomotion
