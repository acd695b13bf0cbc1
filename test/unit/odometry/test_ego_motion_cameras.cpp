// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
// Rigs whose cameras do not overlap, and cameras that fail.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <string>
#include <vector>

#include "scaled_rig.h"
#include "simulated_recording.h"

namespace multicam_egomotion {
namespace {

constexpr double kStretch = 50.0;  // over which drift is measured [m]

/// A vehicle with a camera to each side, at half the resolution.
class SurroundDrive {
 public:
  SurroundDrive() : simulator_(scenario()) {
    for (int frame = 0; frame < simulator_.frames(); ++frame) images_.push_back(simulator_.renderFrame(frame).images);
    recording_ = recordingOf(simulator_);
    recording_.images = [this](int frame) { return images_[frame]; };
  }

  /// Of all frames, without the images of camera `lost` (-1: none) from 1 s on.
  std::vector<EgoMotionResult> run(int lost) const {
    EgoMotion odometry(simulator_.scenario().rig, simulator_.scenario().imu, {});
    const auto lose = [&](int frame, std::vector<CameraImage>* images) {
      if (lost >= 0 && frame >= 10) images->erase(images->begin() + lost);
    };
    return ofFrames(RecordingPlayer(recording_).play(&odometry, 0, recording_.frames, lose), recording_);
  }

  /// Mean error of the position after a stretch, as a share of it.
  double drift(const std::vector<EgoMotionResult>& results) const {
    double sum = 0.0;
    int stretches = 0;
    for (std::size_t i = 0; i < results.size(); ++i) {
      double length = 0.0;
      std::size_t j = i;
      while (length < kStretch && ++j < results.size()) {
        length += motion(results[j - 1].stamp_ns, results[j].stamp_ns).translation().norm();
      }
      if (j >= results.size()) break;
      const Eigen::Isometry3d found = results[i].T_odom_body.pose.inverse() * results[j].T_odom_body.pose;
      const Eigen::Isometry3d truth = motion(results[i].stamp_ns, results[j].stamp_ns);
      sum += (found.translation() - truth.translation()).norm() / length;
      ++stretches;
    }
    return sum / stretches;
  }

  /// Sum of the lengths of the motions between frames over that of the true ones.
  double scale(const std::vector<EgoMotionResult>& results) const {
    double found = 0.0, truth = 0.0;
    for (const EgoMotionResult& one : results) {
      if (one.scale_state != ScaleState::kObservable) continue;
      found += one.T_previous_body.pose.translation().norm();
      truth += motion(one.previous_stamp_ns, one.stamp_ns).translation().norm();
    }
    return found / truth;
  }

  int frames() const { return simulator_.frames(); }

 private:
  static Scenario scenario() {
    Scenario scenario = makeScenario("car_surround");
    scenario.rig = scaledRig(scenario.rig, 0.5);
    return scenario;
  }
  Eigen::Isometry3d motion(std::int64_t from_ns, std::int64_t to_ns) const {
    return simulator_.stateAt(from_ns).T_world_body.inverse() * simulator_.stateAt(to_ns).T_world_body;
  }

  Simulator simulator_;
  std::vector<std::vector<CameraImage>> images_;
  Recording recording_;
};

constexpr double kLeftByCalibration = 0.0025;  // of the distance: the cameras' rotations are found while driving

// The lever between the cameras ahead and behind tells the scale in turns alone. What passes from one camera's view
// into the next tells it always, and with every camera that is left.
TEST(EgoMotionCameras, OneOfFourLostDriftsLittleMore) {
  const SurroundDrive drive;
  const std::vector<EgoMotionResult> all = drive.run(-1);
  const double drift = drive.drift(all);
  std::printf("all cameras: drift %.3f %%, scale %.5f\n", 100.0 * drift, drive.scale(all));
  EXPECT_NEAR(drive.scale(all), 1.0, 0.002);
  for (int lost = 0; lost < 4; ++lost) {
    const std::vector<EgoMotionResult> rest = drive.run(lost);
    const double drift_of_rest = drive.drift(rest), scale = drive.scale(rest);
    std::printf("without camera %d: drift %.3f %%, scale %.5f\n", lost, 100.0 * drift_of_rest, scale);
    EXPECT_EQ(static_cast<int>(rest.size()), drive.frames());
    for (const EgoMotionResult& one : rest) EXPECT_TRUE(one.has_pose);
    EXPECT_LT(drift_of_rest, std::max(1.5 * drift, kLeftByCalibration));
    EXPECT_NEAR(scale, 1.0, 0.004);
  }
}

Scenario handheld(double duration_s) {
  SimulationOptions options;
  options.duration_s = duration_s;
  Scenario scenario = makeScenario("handheld_stereo", options);
  scenario.rig = scaledRig(scenario.rig, 0.5);
  return scenario;
}

/// The rig as a rig file might wrongly have it.
CameraRig withSecondTurned(const CameraRig& rig, const Eigen::Vector3d& turn) {
  std::vector<RigCamera> cameras = rig.cameras();
  cameras[1].T_body_cam.rotate(expSO3(turn));
  return CameraRig(cameras);
}

bool names(const EgoMotion& odometry, const std::string& fault) {
  const std::vector<std::string> faults = odometry.faults();
  return std::any_of(faults.begin(), faults.end(),
                     [&](const std::string& one) { return one.find(fault) != std::string::npos; });
}

// A camera that is not mounted as the rig file says is found, named and corrected, along the epipolar lines (y) too.
TEST(EgoMotionCameras, AWrongMountingIsNamedAndCorrected) {
  const Scenario scenario = handheld(3.0);
  const Simulator simulator(scenario);
  const Recording recording = recordingOf(simulator);
  for (const Eigen::Vector3d turn_deg : {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(0, 1, 0),
                                         Eigen::Vector3d(0, -1, 0), Eigen::Vector3d(0, 0, 1)}) {
    const Eigen::Vector3d turn = turn_deg * M_PI / 180.0;
    EgoMotion odometry(withSecondTurned(scenario.rig, turn), scenario.imu, {});
    const auto results = RecordingPlayer(recording).play(&odometry, 0, recording.frames);
    EXPECT_EQ(names(odometry, "cam1 is turned by"), turn.norm() > 0.0) << turn_deg.transpose();
    ASSERT_EQ(odometry.calibration().size(), 1u);
    EXPECT_LT((odometry.calibration()[0].rotation + turn).norm(), 0.05 * M_PI / 180.0) << turn_deg.transpose();
    const auto published = std::count_if(results.begin(), results.end(), [](const auto& one) { return one.has_pose; });
    EXPECT_GE(published, recording.frames);
    double found = 0.0, truth = 0.0;
    for (const EgoMotionResult& one : results) {
      if (!one.has_relative_pose) continue;
      EXPECT_TRUE(one.T_odom_body.pose.matrix().allFinite());
      found += one.T_previous_body.pose.translation().norm();
      truth += (simulator.stateAt(one.stamp_ns).T_world_body.translation() -
                simulator.stateAt(one.previous_stamp_ns).T_world_body.translation())
                   .norm();
    }
    std::printf("cam1 turned by %.1f %.1f %.1f deg: %.3f of %.3f m\n", turn_deg.x(), turn_deg.y(), turn_deg.z(), found,
                truth);
    EXPECT_NEAR(found / truth, 1.0, 0.02);
  }
}

// Distances between the cameras that are wrong by far more than the rig file says are named by the accelerometer.
TEST(EgoMotionCameras, AWrongBaselineIsNamedAndCorrected) {
  const Scenario scenario = handheld(6.0);
  const Simulator simulator(scenario);
  const Recording recording = recordingOf(simulator);
  for (const double factor : {1.0, 1.12}) {
    std::vector<RigCamera> cameras = scenario.rig.cameras();
    const Eigen::Vector3d first = cameras[0].T_body_cam.translation();
    cameras[1].T_body_cam.translation() = first + factor * (cameras[1].T_body_cam.translation() - first);
    EgoMotion odometry(CameraRig(cameras), scenario.imu, {});
    RecordingPlayer(recording).play(&odometry, 0, recording.frames);
    EXPECT_EQ(names(odometry, "by the accelerometer"), factor != 1.0) << factor;
  }
}

}  // namespace
}  // namespace multicam_egomotion
