// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "simulator/scenario.h"

#include <algorithm>
#include <stdexcept>

#include "simulator/scenario_motion.h"
#include "simulator/scenario_rig.h"
#include "simulator/scenario_scene.h"

namespace multicam_egomotion {

namespace {

/// What a scenario is made of, by name.
struct Recipe {
  std::string name;
  double duration_s;
  double image_rate_hz;
  Trajectory (*motion)();
  RigDescription (*rig)();
  SceneDescription scene;
};

const std::vector<Recipe>& recipes() {
  // Scene: margin, height, floor, boxes per m², smallest and largest side, clearance, sky.
  static const std::vector<Recipe> all = {
      {"handheld_stereo", 20.0, 20.0, handheldMotion, handheldRig, {2.5, 3.6, 0.0, 0.16, 0.3, 1.2, 0.9, false}},
      {"car_surround", 20.0, 10.0, carMotion, carRig, {14.0, 14.0, -0.3, 0.014, 2.0, 9.0, 4.0, true}},
      {"drone_fisheye", 20.0, 20.0, droneMotion, droneRig, {9.0, 12.0, 0.0, 0.05, 0.6, 3.5, 1.6, true}},
      {"straight_line", 15.0, 20.0, straightLineMotion, stereoRig, {3.0, 3.6, 0.0, 0.10, 0.3, 1.4, 1.2, false}},
      {"stop_and_go", 22.0, 20.0, stopAndGoMotion, stereoRig, {4.0, 4.0, 0.0, 0.08, 0.3, 1.6, 1.2, false}},
      {"creep", 13.0, 20.0, creepMotion, stereoRig, {4.0, 3.6, 0.0, 0.16, 0.3, 1.2, 1.2, false}},
      {"loop", 60.0, 20.0, loopMotion, handheldRig, {2.5, 3.6, 0.0, 0.16, 0.3, 1.2, 0.9, false}},
  };
  return all;
}

void expectRange(const char* name, double found, double low, double high) {
  if (!(found >= low && found <= high)) {
    throw std::invalid_argument(std::string(name) + " is " + std::to_string(found) + ", expected " +
                                std::to_string(low) + " to " + std::to_string(high));
  }
}

}  // namespace

const std::vector<std::string>& scenarioNames() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> result;
    for (const Recipe& recipe : recipes()) result.push_back(recipe.name);
    return result;
  }();
  return names;
}

Scenario makeScenario(const std::string& name, const SimulationOptions& options) {
  const auto recipe =
      std::find_if(recipes().begin(), recipes().end(), [&](const Recipe& candidate) { return candidate.name == name; });
  if (recipe == recipes().end()) {
    std::string known;
    for (const std::string& one : scenarioNames()) known += (known.empty() ? "" : ", ") + one;
    throw std::invalid_argument("scenario is \"" + name + "\", expected one of " + known);
  }
  SimulationOptions filled = options;
  if (filled.duration_s == 0.0) filled.duration_s = recipe->duration_s;
  if (filled.image_rate_hz == 0.0) filled.image_rate_hz = recipe->image_rate_hz;
  RigDescription rig = recipe->rig();
  if (filled.cameras == 0) filled.cameras = static_cast<int>(rig.cameras.size());
  expectRange("duration_s", filled.duration_s, 0.1, 3600.0);
  expectRange("image_rate_hz", filled.image_rate_hz, 0.5, 500.0);
  expectRange("cameras", filled.cameras, 1, static_cast<double>(rig.cameras.size()));
  expectRange("imu_rate_hz", filled.imu_rate_hz, 10.0, 5000.0);
  expectRange("image_noise", filled.image_noise, 0.0, 100.0);
  expectRange("imu_noise_scale", filled.imu_noise_scale, 0.0, 1000.0);
  expectRange("gyroscope_bias", filled.gyroscope_bias, 0.0, 1.0);
  expectRange("accelerometer_bias", filled.accelerometer_bias, 0.0, 5.0);
  expectRange("time_offset_s", filled.time_offset_s, -0.2, 0.2);
  rig.cameras.erase(rig.cameras.begin() + filled.cameras, rig.cameras.end());
  for (RigCamera& camera : rig.cameras) camera.time_offset_s = filled.time_offset_s;
  rig.imu.rate_hz = filled.imu_rate_hz;
  rig.imu.topic = "/imu";

  const Trajectory trajectory = recipe->motion();
  auto scene = makeScene(recipe->scene, trajectory, filled.duration_s, filled.seed);
  return {name, filled, CameraRig(rig.cameras), rig.imu, trajectory, scene};
}

}  // namespace multicam_egomotion
