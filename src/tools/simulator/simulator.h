// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "multicam_egomotion/imu/imu_sample.h"
#include "multicam_egomotion/tracking/frame_set.h"
#include "simulator/renderer.h"
#include "simulator/scenario.h"

namespace multicam_egomotion {

/// An inertial measurement with what is true at its stamp.
struct SimulatedImu {
  ImuSample sample;
  Eigen::Vector3d gyroscope_bias;      ///< [rad/s]
  Eigen::Vector3d accelerometer_bias;  ///< [m/s^2]
};

/// Images, IMU samples and exact ground truth of one scenario. Deterministic: the same scenario gives the same bits,
/// whatever the number of threads.
class Simulator {
 public:
  static constexpr double kGravity = 9.81;  ///< [m/s^2], along -z of the world
  static constexpr double kImuLead = 0.5;   ///< the IMU starts so long before the first image [s]
  static constexpr std::int64_t kFirstStamp = 1600000000000000000;  ///< of the first image [ns]

  explicit Simulator(const Scenario& scenario);

  const Scenario& scenario() const { return scenario_; }
  int frames() const { return frames_; }
  std::int64_t frameStamp(int frame) const;

  /// True state of the body at a stamp of the IMU's clock.
  BodyState stateAt(std::int64_t stamp_ns) const;
  /// True state of the body when the images of a frame were taken: stamp + time_offset_s.
  BodyState stateAtFrame(int frame) const;

  /// All samples from kImuLead before the first to a little after the last image.
  std::vector<SimulatedImu> imu() const;
  std::vector<ImuSample> imuSamples() const;

  /// Images of all cameras; renders with `threads` threads (0: as many as the machine has).
  FrameSet renderFrame(int frame, int threads = 0) const;
  /// Image of one camera with the body anywhere, without noise, CV_32FC1.
  cv::Mat renderImage(int camera, const Eigen::Isometry3d& T_world_body, int threads = 0) const;

  /// Distance from the camera centre to the scene along a pixel's bearing [m]; infinite for the sky, NaN where the
  /// model sees nothing.
  double distance(int camera, const Eigen::Isometry3d& T_world_body, const Eigen::Vector2d& pixel) const;

 private:
  Scenario scenario_;
  int frames_;
  std::vector<Renderer> renderers_;
};

}  // namespace multicam_egomotion
