// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "bag_runner/bag_replay.h"
#include "fault_injection/corrupted_bag.h"
#include "fault_row.h"
#include "multicam_egomotion/geometry/so3.h"
#include "multicam_egomotion/ros/diagnostics.h"

namespace multicam_egomotion {

/// What /diagnostics would have said with a result.
struct Said {
  std::int64_t stamp_ns;  ///< of the result; 0: at the end, and there was none
  std::string summary, gyroscope;
};

/// What came out of one bag: results, and what /diagnostics would have said.
struct FaultRun {
  std::vector<EgoMotionResult> results;
  std::map<std::string, std::string> diagnostics;  ///< values at the end
  std::vector<Said> said;                          ///< with each result
  std::string refusal;                             ///< the error, where nothing ran
};

inline FaultRun runBag(const std::string& path, const Parameters& parameters) {
  FaultRun run;
  rosbag::Bag bag(path, rosbag::bagmode::Read);
  try {
    BagReplay replay(bag, parameters);
    RunReport report;
    Health health;
    health.state = Health::State::kRunning;
    health.use_imu = parameters.odometry.use_imu;
    health.rate_hz = 1.0;
    const auto observe = [&] {
      health.counters = replay.odometry().counters();
      health.faults = replay.odometry().faults();
      health.gyroscope_check = replay.odometry().gyroscopeCheck();
      health.undecodable_images = report.undecodable_images;
      diagnostic_updater::DiagnosticStatusWrapper status;
      describe(health, status);
      for (const auto& value : status.values) run.diagnostics[value.key] = value.value;
      run.said.push_back({health.result ? health.result->stamp_ns : 0, status.message, run.diagnostics["gyroscope"]});
    };
    replay.play(
        [&](const EgoMotionResult& result, const ros::Time&) {
          run.results.push_back(result);
          health.result = result;
          observe();
        },
        &report);
    observe();
  } catch (const std::invalid_argument& error) {
    run.refusal = error.what();
  }
  return run;
}

/// A recording whose truth is known, and what the odometry makes of it without faults.
struct TrueRecording {
  std::string bag;
  Parameters parameters;
  std::int64_t begin_ns = 0;                                      ///< of the bag
  std::vector<std::int64_t> image_stamps_ns;                      ///< of camera 0
  std::function<Eigen::Isometry3d(std::int64_t stamp_ns)> truth;  ///< pose of the body in a world with z up
  FaultRun clean;

  double since(std::int64_t stamp_ns) const { return 1e-9 * static_cast<double>(stamp_ns - begin_ns); }
};

/// A pose that came out, its truth, and when that was [s since the bag's begin].
struct JudgedPose {
  double time_s;
  Eigen::Isometry3d truth;
  const EgoMotionResult* result;
};

/// The poses of a run. Where the faults move the stamps from `begin_s` on, those of images are moved back; poses
/// between images, whose time is then not known, are left out.
inline std::vector<JudgedPose> judgedPoses(const TrueRecording& recording, const FaultRun& run, double begin_s,
                                           double shift_s) {
  const auto shift_ns = static_cast<std::int64_t>(std::llround(1e9 * shift_s));
  std::map<std::int64_t, std::int64_t> recorded_stamps;  // by the stamp that came out
  for (const std::int64_t stamp : recording.image_stamps_ns) {
    recorded_stamps[recording.since(stamp) < begin_s ? stamp : stamp + shift_ns] = stamp;
  }
  std::vector<JudgedPose> poses;
  for (const EgoMotionResult& result : run.results) {
    const auto recorded = recorded_stamps.find(result.stamp_ns);
    if (!result.has_pose || (shift_ns != 0 && recorded == recorded_stamps.end())) continue;
    const std::int64_t stamp_ns = shift_ns != 0 ? recorded->second : result.stamp_ns;
    poses.push_back({recording.since(stamp_ns), recording.truth(stamp_ns), &result});
  }
  return poses;
}

/// Deviation from the truth of the motion since a pose.
struct Drift {
  int poses = 0;
  double position_m = 0.0, angle_deg = 0.0;  ///< the largest
  int beyond_three_sigma = 0;                ///< positions further off than the growth of the covariance allows
};

/// Drift over the poses from `begin_s` to `end_s`, anew in each odom epoch.
inline Drift driftBetween(const std::vector<JudgedPose>& poses, double begin_s, double end_s) {
  constexpr double kThreeSigma = 14.156;  // chi-square with 3 degrees of freedom, 99.73 %
  constexpr double kNoise = 0.003;        // of a single pose [m]
  Drift drift;
  const JudgedPose* first = nullptr;
  for (const JudgedPose& pose : poses) {
    if (pose.time_s < begin_s || pose.time_s > end_s) continue;
    ++drift.poses;
    if (first == nullptr || first->result->odom_epoch != pose.result->odom_epoch) first = &pose;
    const Eigen::Isometry3d& start = first->result->T_odom_body.pose;
    const Eigen::Isometry3d expected = start * first->truth.inverse() * pose.truth;
    const Eigen::Isometry3d& found = pose.result->T_odom_body.pose;
    const Eigen::Vector3d error = found.translation() - expected.translation();
    drift.position_m = std::max(drift.position_m, error.norm());
    drift.angle_deg =
        std::max(drift.angle_deg, 180.0 / M_PI * logSO3(expected.linear().transpose() * found.linear()).norm());
    const Matrix6d growth = pose.result->T_odom_body.covariance - first->result->T_odom_body.covariance;
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(growth.topLeftCorner<3, 3>());
    const Eigen::Vector3d along = eigen.eigenvectors().transpose() * error;
    const Eigen::Array3d variance = eigen.eigenvalues().array().max(0.0) + kNoise * kNoise;
    drift.beyond_three_sigma += (along.array().square() / variance).sum() > kThreeSigma;
  }
  return drift;
}

/// Share of the recording's images of camera 0 that have a pose less than half a period away.
inline double shareOfPoses(const TrueRecording& recording, const std::vector<JudgedPose>& poses) {
  const std::vector<std::int64_t>& stamps = recording.image_stamps_ns;
  const double half = 0.5 * (recording.since(stamps.back()) - recording.since(stamps.front())) / (stamps.size() - 1);
  int answered = 0;
  for (const std::int64_t stamp : stamps) {
    const double time_s = recording.since(stamp);
    answered += std::any_of(poses.begin(), poses.end(),
                            [&](const JudgedPose& pose) { return std::abs(pose.time_s - time_s) <= half; });
  }
  return static_cast<double>(answered) / static_cast<double>(stamps.size());
}

}  // namespace multicam_egomotion
