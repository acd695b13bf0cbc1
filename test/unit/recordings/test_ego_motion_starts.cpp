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
  double vertical_error;  // of what is known of the vertical by then [deg]
  double scale;           // of the last motion between frames
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
  SCOPED_TRACE(moving.name + " from frame " + std::to_string(first));
  const Eigen::Vector3d up = moving.truth(result.stamp_ns).linear().row(2).transpose();
  const double vertical_error = result.up.cross(up).norm();
  EXPECT_LT(vertical_error, 3.0 * result.tilt_sigma);
  // The attitude of odom follows it no further than its sigma.
  const Eigen::Vector3d up_in_odom = result.T_odom_body.pose.linear() * up;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> tilt(result.T_odom_body.covariance.block<2, 2>(3, 3));
  const double tilt_error = up_in_odom.head<2>().norm(), tilt_sigma = std::sqrt(tilt.eigenvalues()[1]);
  EXPECT_LT(tilt_error, 3.0 * tilt_sigma);
  const Eigen::Isometry3d T = moving.truth(result.previous_stamp_ns).inverse() * moving.truth(result.stamp_ns);
  const StartOutcome outcome{vertical_error * kDegreesPerRadian,
                             result.T_previous_body.pose.translation().norm() / T.translation().norm()};
  std::printf("%s from frame %d: vertical %.2f deg off, sigma %.2f; attitude %.2f, %.2f; scale %.3f\n",
              moving.name.c_str(), first, outcome.vertical_error, result.tilt_sigma * kDegreesPerRadian,
              tilt_error * kDegreesPerRadian, tilt_sigma * kDegreesPerRadian, outcome.scale);
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
  for (const StartOutcome& outcome : outcomes) EXPECT_LT(outcome.vertical_error, largest_deg);
}

TEST(EgoMotionStarts, HandheldInMotion) { expectVertical(outcomesOf(simulatedRecording("handheld_stereo"), 1), 2.5); }

// Cameras without overlap see the scale only through the rotation, which tells little before some of it is done: it is
// found from far off, and the vertical with it.
TEST(EgoMotionStarts, CarInMotion) {
  const StartOutcome outcome = outcomeOf(simulatedRecording("car_surround"), 44);
  EXPECT_NEAR(outcome.scale, 1.0, 0.1);
  expectVertical({outcome}, 2.5);
}

TEST(EgoMotionStarts, RecordedInMotion) {
  const std::optional<EurocExcerpt> euroc = eurocExcerpt();
  if (!euroc) GTEST_SKIP() << "euroc_mh01_excerpt is not there";
  const auto truth = [&](std::int64_t stamp_ns) { return poseAt(euroc->truth, stamp_ns); };
  expectVertical(outcomesOf({"euroc_mh01_excerpt", euroc->rig, euroc->imu, euroc->recording, truth}, 2), 2.5);
}

}  // namespace
}  // namespace multicam_egomotion
