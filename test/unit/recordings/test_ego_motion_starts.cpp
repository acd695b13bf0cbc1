// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
// Starts in the middle of a motion, images and IMU from the same moment on.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
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

constexpr double kDegreesPerRadian = 180.0 / M_PI;
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

struct StartOutcome {
  double tilt_error, tilt_sigma;  // [deg]
  double scale;                   // of the last motion between frames
};

/// In the span of a start.
int framesIn(const Recording& recording) {
  return static_cast<int>(std::lround(kSpan * 1e9 / static_cast<double>(recording.stamp(1) - recording.stamp(0))));
}

double speedAt(const MovingRecording& moving, int frame) {
  const std::int64_t before = moving.recording.stamp(frame), after = moving.recording.stamp(frame + 1);
  return (moving.truth(after).translation() - moving.truth(before).translation()).norm() /
         (1e-9 * static_cast<double>(after - before));
}

StartOutcome outcomeOf(const MovingRecording& moving, int first) {
  Recording from_there = moving.recording;
  const std::int64_t begin_ns = moving.recording.stamp(first);
  from_there.imu.erase(from_there.imu.begin(),
                       std::lower_bound(from_there.imu.begin(), from_there.imu.end(), begin_ns,
                                        [](const ImuSample& one, std::int64_t ns) { return one.stamp_ns < ns; }));
  EgoMotion odometry(moving.rig, moving.imu, {});
  const EgoMotionResult result =
      RecordingPlayer(from_there).play(&odometry, first, first + framesIn(moving.recording) + 1).back();
  EXPECT_TRUE(result.has_pose) << moving.name << " from frame " << first;
  const Eigen::Vector3d up =
      result.T_odom_body.pose.linear() * moving.truth(result.stamp_ns).linear().row(2).transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> tilt(result.T_odom_body.covariance.block<2, 2>(3, 3));
  const Eigen::Isometry3d T = moving.truth(result.previous_stamp_ns).inverse() * moving.truth(result.stamp_ns);
  const StartOutcome outcome{std::atan2(up.head<2>().norm(), up.z()) * kDegreesPerRadian,
                             std::sqrt(tilt.eigenvalues()[1]) * kDegreesPerRadian,
                             result.T_previous_body.pose.translation().norm() / T.translation().norm()};
  std::printf("%s from frame %d: tilt error %.2f deg, sigma %.2f deg, scale %.3f\n", moving.name.c_str(), first,
              outcome.tilt_error, outcome.tilt_sigma, outcome.scale);
  EXPECT_LT(outcome.tilt_error, 3.0 * outcome.tilt_sigma) << moving.name << " from frame " << first;
  return outcome;
}

/// From random frames.
std::vector<StartOutcome> outcomesOf(const MovingRecording& moving, int starts) {
  std::mt19937 random(1);
  std::vector<StartOutcome> outcomes;
  while (static_cast<int>(outcomes.size()) < starts) {
    const int last = moving.recording.frames - framesIn(moving.recording) - 2;
    const int first = std::uniform_int_distribution<int>(0, last)(random);
    if (speedAt(moving, first) > kLeastSpeed) outcomes.push_back(outcomeOf(moving, first));
  }
  return outcomes;
}

void expectVertical(const std::vector<StartOutcome>& outcomes, double largest_deg) {
  for (const StartOutcome& outcome : outcomes) EXPECT_LT(outcome.tilt_error, largest_deg);
}

TEST(EgoMotionStarts, HandheldInMotion) { expectVertical(outcomesOf(simulatedRecording("handheld_stereo"), 1), 2.5); }

// Cameras without overlap see the scale only through the rotation, which tells little before some of it is done: the
// vertical may take longer, and its sigma has to say so. The scale is found from far off.
TEST(EgoMotionStarts, CarInMotion) { EXPECT_NEAR(outcomeOf(simulatedRecording("car_surround"), 44).scale, 1.0, 0.1); }

TEST(EgoMotionStarts, RecordedInMotion) {
  const std::optional<EurocExcerpt> euroc = eurocExcerpt();
  if (!euroc) GTEST_SKIP() << "euroc_mh01_excerpt is not there";
  const auto truth = [&](std::int64_t stamp_ns) { return poseAt(euroc->truth, stamp_ns); };
  expectVertical(outcomesOf({"euroc_mh01_excerpt", euroc->rig, euroc->imu, euroc->recording, truth}, 2), 2.5);
}

}  // namespace
}  // namespace multicam_egomotion
