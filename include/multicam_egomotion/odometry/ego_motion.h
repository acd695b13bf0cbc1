// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "multicam_egomotion/geometry/camera_rig.h"
#include "multicam_egomotion/imu/imu_calibration.h"
#include "multicam_egomotion/imu/imu_sample.h"
#include "multicam_egomotion/odometry/ego_motion_options.h"
#include "multicam_egomotion/odometry/ego_motion_result.h"
#include "multicam_egomotion/tracking/frame_set.h"

namespace multicam_egomotion {

/// Faults of the data since the start; nothing here stops the odometry.
struct EgoMotionCounters {
  std::uint64_t frame_sets = 0;
  std::uint64_t frame_sets_without_imu = 0;  ///< processed although the IMU did not reach their stamp
  std::uint64_t estimation_failures = 0;     ///< too few correspondences or no consensus
  std::uint64_t time_jumps = 0;
  std::uint64_t rejected_imu = 0;
  std::uint64_t late_images = 0;
  std::uint64_t rejected_images = 0;  ///< wrong size, unknown camera, invalid stamp
};

/// The whole chain from images and IMU samples to metric ego-motion: the one class that nodelet, node, bag runner and
/// tests drive. Single-threaded, reads no clock, deterministic: the same calls and seed give the same bits.
class EgoMotion {
 public:
  /// Throws std::invalid_argument (name, found, expected) on options that cannot be.
  EgoMotion(const CameraRig& rig, const ImuCalibration& imu, const EgoMotionOptions& options);
  ~EgoMotion();
  EgoMotion(const EgoMotion&) = delete;
  EgoMotion& operator=(const EgoMotion&) = delete;

  void addImu(const ImuSample& sample);
  /// Grey image; `now_ns`: data time of its arrival (for the assembler's timeout), at least the image's stamp.
  void addImage(const CameraImage& image, std::int64_t now_ns);

  /// Advances to `now_ns` (data time): processes what is ready, coasts where images are missing; oldest result first.
  std::vector<EgoMotionResult> advance(std::int64_t now_ns);
  /// Processes everything that is still waiting, as at the end of a bag.
  std::vector<EgoMotionResult> finish();

  /// New odom origin at the next frame, odom_epoch + 1; biases are kept unless `forget_biases` (contract 13).
  void reset(bool forget_biases = false);
  /// The same with a given pose of the body in odom for the next frame.
  void setPose(const Eigen::Isometry3d& T_odom_body);

  /// State propagated with the gyroscope and accelerometer to the newest IMU sample, for controllers: stamp, pose,
  /// twist and status. Empty before the first pose, without IMU and once LOST.
  std::optional<EgoMotionResult> predictToLatestImu() const;

  /// Called after each stage of a frame ("tracking", "ransac", "window", "frame"), so that a caller who has a clock can
  /// time them.
  void setStageObserver(std::function<void(const char* stage)> observer);
  /// Mask of a camera (CV_8UC1, 0 = ignore); throws std::invalid_argument when its size is not the camera's.
  void setMask(int camera, const cv::Mat& mask);

  /// Takes over what may change between two frames: solver, ransac.max_epipolar_error_px, tracker.features_per_camera
  /// and tracker.fast_threshold; the rest stays. Throws as the constructor and then changes nothing.
  void tune(const EgoMotionOptions& options);

  const CameraRig& rig() const;
  const EgoMotionOptions& options() const;
  EgoMotionCounters counters() const;
  /// What is wrong with the data now, one line each that says what was found and what was expected.
  std::vector<std::string> faults() const;
  /// Whether the gyroscope agrees with the images, or that this cannot be told yet.
  std::string gyroscopeCheck() const;
  /// Of each camera that is calibrated while running; empty without `calibrate_online`.
  std::vector<CameraCalibration> calibration() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace multicam_egomotion
