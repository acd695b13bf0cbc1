// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "multicam_egomotion/tracking/tracked_frame.h"
#include "simulator/scenario.h"

namespace multicam_egomotion {

struct TrackSimulationOptions {
  std::uint64_t seed = 1;
  double pixel_sigma = 0.3;     ///< Gaussian noise of an observation, per axis [px]
  int tracks_per_camera = 150;  ///< new points are born where a camera sees fewer
  double border_px = 8.0;       ///< observations stay so far inside the image
  double min_range = 0.3;       ///< [m]
  double max_range = 60.0;      ///< [m]
  double loss_share = 0.02;     ///< of the tracks end for no reason, each frame
  double outlier_share = 0.0;   ///< of the observations are 5 to 40 px off in any direction
  bool cross_camera = true;     ///< a point in view of several cameras is seen by all, under one id
};

/// What a perfect tracker would give, with the truth beside it.
struct SimulatedTracks {
  std::vector<TrackedFrame> frames;                     ///< at the stamps of Simulator::frameStamp
  std::vector<std::vector<bool>> outlier;               ///< parallel to frames[i].observations
  std::unordered_map<TrackId, Eigen::Vector3d> points;  ///< world [m]
};

/// Points on the surfaces of the scene (on any distance, by random pixels), projected into each camera of the rig with
/// occlusion, image border and range; no images are rendered. Deterministic.
SimulatedTracks simulateTracks(const Scenario& scenario, const TrackSimulationOptions& options = {});

}  // namespace multicam_egomotion
