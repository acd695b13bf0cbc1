// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "multicam_egomotion/geometry/camera_rig.h"
#include "multicam_egomotion/imu/imu_calibration.h"
#include "simulator/scene.h"
#include "simulator/trajectory.h"

namespace multicam_egomotion {

struct SimulationOptions {
  std::uint64_t seed = 1;            ///< of scene, noise and biases
  double duration_s = 0.0;           ///< from the first to the last image [s]; 0: the scenario's own
  double image_rate_hz = 0.0;        ///< 0: the scenario's own
  int cameras = 0;                   ///< the first so many of the rig; 0: all
  double imu_rate_hz = 200.0;        ///< [Hz]
  double image_noise = 1.5;          ///< standard deviation [grey levels]
  double imu_noise_scale = 1.0;      ///< of noise, bias walk and initial biases; 0: exact samples
  double gyroscope_bias = 0.02;      ///< standard deviation of the initial bias, per axis [rad/s]
  double accelerometer_bias = 0.08;  ///< the same [m/s^2]
  double time_offset_s = 0.0;        ///< of all cameras: t_imu = t_image + time_offset_s
};

/// Everything that is true of one simulated run.
struct Scenario {
  std::string name;
  SimulationOptions options;  ///< nothing left at 0
  CameraRig rig;
  ImuCalibration imu;
  Trajectory trajectory;  ///< of base_link, t = 0 at the first image
  std::shared_ptr<const Scene> scene;
};

/// handheld_stereo, car_surround, drone_fisheye, straight_line, stop_and_go, creep, loop.
const std::vector<std::string>& scenarioNames();

/// Throws std::invalid_argument (name, found, expected) on an unknown name, more cameras than the rig has, or options
/// out of range.
Scenario makeScenario(const std::string& name, const SimulationOptions& options = {});

}  // namespace multicam_egomotion
