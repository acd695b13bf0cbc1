// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "camera_poses.h"
#include "multicam_egomotion/geometry/covariance.h"
#include "multicam_egomotion/geometry/so3.h"
#include "multicam_egomotion/odometry/frame_consensus.h"
#include "multicam_egomotion/odometry/window.h"
#include "simulator/simulator.h"
#include "simulator/track_simulator.h"

namespace multicam_egomotion {

inline SimulationOptions lasting(double seconds, std::uint64_t seed = 1, int cameras = 0) {
  SimulationOptions options;
  options.duration_s = seconds;
  options.seed = seed;
  options.cameras = cameras;
  return options;
}

/// Normalized squared errors of one kind.
struct Consistency {
  double sum = 0.0;
  int count = 0, inside = 0;
  int dimension = 1;

  void add(double nees, int degrees_of_freedom) {
    static constexpr double kBound95[] = {0.0, 3.841, 5.991, 7.815};
    dimension = degrees_of_freedom;
    sum += nees;
    inside += nees < kBound95[degrees_of_freedom];
    ++count;
  }
  double mean() const { return sum / std::max(1, count) / dimension; }  ///< of NEES per degree of freedom
  double share() const { return static_cast<double>(inside) / std::max(1, count); }
};

struct WindowRunOptions {
  TrackSimulationOptions tracks;
  bool consensus = false;        ///< RANSAC removes outliers first
  double rotation_sigma = 3e-4;  ///< of the gyroscope between two frames, per axis [rad]
  double speed_sigma = 0.2;      ///< of the predicted velocity, per axis [m/s]
  WindowOptions window;
};

/// A Window over the tracks of a simulated scenario, with a gyroscope and a velocity of stated accuracy.
struct WindowRun {
  Consistency rotation, direction, scale;
  std::map<ScaleState, int> states;         ///< how many frames
  std::map<ScaleState, int> moving_states;  ///< among those with more than 5 mm of motion
  double path = 0.0, position_error = 0.0;  ///< at the end [m]
  double rotation_error = 0.0;              ///< at the end [rad]
  double largest_position_error = 0.0;      ///< [m]
  double median_direction_error = 0.0;      ///< of moving frames [rad]
  int failures = 0, frames = 0, outliers_found = 0, outliers_missed = 0, inliers_lost = 0, observations = 0;
};

inline TrackedFrame withoutTracks(const TrackedFrame& frame, const std::vector<TrackId>& gone) {
  TrackedFrame kept;
  kept.stamp_ns = frame.stamp_ns;
  for (const FeatureObservation& one : frame.observations) {
    if (!std::binary_search(gone.begin(), gone.end(), one.track)) kept.observations.push_back(one);
  }
  return kept;
}

/// What a gyroscope and a velocity with the stated errors say of the true motion `T_a_b` over `dt` [s].
inline MotionSummary predictedMotion(const Eigen::Isometry3d& T_a_b, const WindowRunOptions& options, double dt,
                                     std::mt19937* random) {
  std::normal_distribution<double> normal;
  const auto noise = [&](double sigma) {
    const double x = normal(*random), y = normal(*random), z = normal(*random);
    return Eigen::Vector3d(sigma * Eigen::Vector3d(x, y, z));
  };
  MotionSummary motion;
  const double sigma = options.speed_sigma * dt;
  motion.T_a_b.linear() = T_a_b.linear() * expSO3(noise(options.rotation_sigma));
  motion.T_a_b.translation() = T_a_b.translation() + noise(sigma);
  motion.rotation_covariance = options.rotation_sigma * options.rotation_sigma * Eigen::Matrix3d::Identity();
  motion.translation_covariance = sigma * sigma * Eigen::Matrix3d::Identity();
  return motion;
}

/// A window over simulated tracks, started at the true pose of a frame.
class SimulatedWindow {
 public:
  /// `given`: the rig as the window is told that it is.
  SimulatedWindow(const Scenario& scenario, const TrackSimulationOptions& options, int first, const CameraRig& given,
                  const RigCalibration& calibration = {}, const WindowOptions& window = {})
      : simulator_(scenario),
        tracks_(simulateTracks(scenario, options)),
        T_body_cam_(cameraPosesOf(given)),
        window_(window, calibration) {
    start(first);
  }
  SimulatedWindow(const Scenario& scenario, const TrackSimulationOptions& options, int first)
      : SimulatedWindow(scenario, options, first, scenario.rig) {}

  void start(int frame) {
    const TrackedFrame& seen = tracks_.frames[frame];
    window_.start(seen.stamp_ns, truth(frame), Matrix6d::Zero(), seen, T_body_cam_);
  }

  int frames() const { return simulator_.frames(); }
  const SimulatedTracks& tracks() const { return tracks_; }
  const std::vector<Eigen::Isometry3d>& cameraPoses() const { return T_body_cam_; }
  const Window& window() const { return window_; }
  Eigen::Isometry3d truth(int frame) const { return simulator_.stateAtFrame(frame).T_world_body; }
  /// True motion of the body from the frame before.
  Eigen::Isometry3d motionTo(int frame) const { return truth(frame - 1).inverse() * truth(frame); }
  WindowEstimate add(int frame, const MotionSummary& motion) {
    return window_.add(tracks_.frames[frame], T_body_cam_, motion, {motion.T_a_b});
  }

 private:
  Simulator simulator_;
  SimulatedTracks tracks_;
  std::vector<Eigen::Isometry3d> T_body_cam_;
  Window window_;
};

inline WindowRun runWindow(const Scenario& scenario, const WindowRunOptions& options) {
  const Simulator simulator(scenario);
  SimulatedTracks tracks = simulateTracks(scenario, options.tracks);
  const std::vector<Eigen::Isometry3d> T_body_cam = cameraPosesOf(scenario.rig);
  std::mt19937 random(static_cast<unsigned>(options.tracks.seed) + 100);
  const double dt = 1.0 / scenario.options.image_rate_hz;
  const auto truth = [&](int frame) { return simulator.stateAtFrame(frame).T_world_body; };

  WindowRun run;
  Window window(options.window);
  window.start(tracks.frames[0].stamp_ns, truth(0), Matrix6d::Zero(), tracks.frames[0], T_body_cam);
  bool scale_seen = false;
  std::vector<double> direction_errors;
  PosedFrame previous{tracks.frames[0], T_body_cam};
  for (std::size_t i = 1; i < tracks.frames.size(); ++i) {
    const int frame = static_cast<int>(i);
    const Eigen::Isometry3d T_true = truth(frame - 1).inverse() * truth(frame);
    MotionSummary motion = predictedMotion(T_true, options, dt, &random);
    motion.use_translation = !scale_seen;
    PosedFrame newest{tracks.frames[i], T_body_cam};
    std::vector<Eigen::Isometry3d> guesses = {motion.T_a_b};
    if (options.consensus) {
      const Eigen::Vector3d up = truth(frame - 1).linear().transpose() * Eigen::Vector3d::UnitZ();
      const FrameConsensus consensus = findConsensus(previous, newest, motion, up, "auto", {}, frame);
      if (consensus.success) {
        newest.frame = withoutTracks(newest.frame, consensus.outliers);
        guesses.push_back(consensus.T_previous_body);
      }
    }
    const WindowEstimate estimate = window.add(newest.frame, T_body_cam, motion, guesses);
    ++run.frames;
    run.path += T_true.translation().norm();
    if (!estimate.ok) {
      ++run.failures;
      window.start(newest.frame.stamp_ns, truth(frame), Matrix6d::Zero(), newest.frame, T_body_cam);
      previous = newest;
      continue;
    }
    // A tracker ends the tracks that were found to be outliers.
    std::vector<TrackId> gone = estimate.outliers;
    std::sort(gone.begin(), gone.end());
    for (std::size_t k = 0; k < tracks.frames[i].observations.size(); ++k) {
      const TrackId id = tracks.frames[i].observations[k].track;
      const bool kept = std::binary_search(estimate.inliers.begin(), estimate.inliers.end(), id);
      ++run.observations;
      (tracks.outlier[i][k] ? (kept ? run.outliers_missed : run.outliers_found) : run.inliers_lost) +=
          tracks.outlier[i][k] || !kept;
    }
    newest.frame = withoutTracks(newest.frame, gone);

    const Eigen::Isometry3d& T = estimate.relative.T_a_b;
    const Matrix6d& covariance = estimate.relative.covariance;
    const Eigen::Vector3d rotation = logSO3(T_true.linear() * T.linear().transpose());
    run.rotation.add(squaredMahalanobis(rotation, covariance.bottomRightCorner<3, 3>()), 3);
    ++run.states[estimate.scale_state];
    const double distance = T_true.translation().norm();
    if (distance > 0.005) ++run.moving_states[estimate.scale_state];
    if (estimate.scale_state != ScaleState::kNotApplicable && distance > 0.005) {
      const double length = T.translation().norm();
      const Eigen::Vector3d t = T.translation() / length;
      Eigen::Matrix<double, 3, 2> tangent;
      tangent.col(0) = t.unitOrthogonal();
      tangent.col(1) = t.cross(tangent.col(0));
      const Eigen::Vector2d off = tangent.transpose() * T_true.translation() / distance;
      const Eigen::Matrix2d off_covariance =
          tangent.transpose() * covariance.topLeftCorner<3, 3>() * tangent / (length * length);
      run.direction.add(squaredMahalanobis(off, off_covariance), 2);
      direction_errors.push_back(std::atan2(off.norm(), t.dot(T_true.translation()) / distance));
      if (estimate.scale_state == ScaleState::kObservable) {
        const double along = t.dot(covariance.topLeftCorner<3, 3>() * t);
        run.scale.add((distance - length) * (distance - length) / along, 1);
      }
    }
    if (estimate.scale_state != ScaleState::kNotApplicable) {
      scale_seen = estimate.scale_state == ScaleState::kObservable;
    }
    const Eigen::Isometry3d error = truth(frame).inverse() * estimate.T_odom_body;
    run.position_error = error.translation().norm();
    run.rotation_error = logSO3(error.linear()).norm();
    run.largest_position_error = std::max(run.largest_position_error, run.position_error);
    previous = newest;
  }
  if (!direction_errors.empty()) {
    std::nth_element(direction_errors.begin(), direction_errors.begin() + direction_errors.size() / 2,
                     direction_errors.end());
    run.median_direction_error = direction_errors[direction_errors.size() / 2];
  }
  return run;
}

}  // namespace multicam_egomotion
