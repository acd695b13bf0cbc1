// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "multicam_egomotion/odometry/ego_motion_options.h"

#include <cmath>
#include <stdexcept>
#include <string>

namespace multicam_egomotion {
namespace {

void require(bool ok, const std::string& name, const std::string& found, const std::string& expected) {
  if (!ok) throw std::invalid_argument("parameter " + name + " is " + found + ", expected " + expected);
}

}  // namespace

void validate(const EgoMotionOptions& options) {
  require(options.solver == "auto" || options.solver == "4pt-vertical" || options.solver == "4pt-axis", "solver",
          options.solver, "auto, 4pt-vertical or 4pt-axis");
  require(options.imu_orientation == "filter" || options.imu_orientation == "message", "imu_orientation",
          options.imu_orientation, "filter or message");
  require(options.on_time_jump == "reset" || options.on_time_jump == "continue", "on_time_jump", options.on_time_jump,
          "reset or continue");
  const auto positive = [](double value, const char* name) {
    require(std::isfinite(value) && value > 0.0, name, std::to_string(value), "a positive number");
  };
  positive(options.max_imu_wait_s, "max_imu_wait_s");
  positive(options.max_coast_s, "max_coast_s");
  positive(options.max_tilt_correction_rate, "max_tilt_correction_rate");
  positive(options.constant_rate_sigma, "constant_rate_sigma");
  positive(options.initial_velocity_sigma, "initial_velocity_sigma");
  positive(options.ransac.max_epipolar_error_px, "ransac/max_epipolar_error_px");
  positive(options.window.initial_pixel_sigma, "window/initial_pixel_sigma");
  require(options.window.max_keyframes >= 2 && options.window.max_keyframes <= 30, "window/max_keyframes",
          std::to_string(options.window.max_keyframes), "2 to 30");
}

}  // namespace multicam_egomotion
