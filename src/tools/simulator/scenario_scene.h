// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>

#include "simulator/scene.h"
#include "simulator/trajectory.h"

namespace multicam_egomotion {

/// A hall or yard about a trajectory, with random boxes that stay clear of it.
struct SceneDescription {
  double margin;              ///< from the trajectory to the walls [m]
  double height;              ///< of the walls [m]
  double floor;               ///< height of the floor [m]
  double box_density;         ///< boxes per square metre of floor
  double min_side, max_side;  ///< of a box [m]
  double clearance;           ///< horizontal distance of the boxes from the trajectory, at least [m]
  bool open_sky;
};

std::shared_ptr<const Scene> makeScene(const SceneDescription& description, const Trajectory& trajectory,
                                       double duration_s, std::uint64_t seed);

}  // namespace multicam_egomotion
