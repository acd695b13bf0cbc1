// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace multicam_egomotion {

using TrackId = std::uint64_t;

/// One point seen by one camera in one frame set. Observations of the same point, in time and in other cameras, share
/// the track id.
struct FeatureObservation {
  TrackId track = 0;
  int camera = 0;
  Eigen::Vector2d pixel;    ///< distorted image coordinates [px]
  Eigen::Vector3d bearing;  ///< unit, optical frame
  /// Maps a bearing difference to pixels around the observation: pixel error of a predicted point p (optical frame) is
  /// to_pixel * (p / (bearing · p) - bearing), 2x3 [px].
  Eigen::Matrix<double, 2, 3> to_pixel;
};

/// Where the point of a track is in the newest body frame.
struct TrackedPoint {
  TrackId track = 0;
  Eigen::Vector3d position;  ///< [m]
};

/// Features of one frame set, sorted by (track, camera).
struct TrackedFrame {
  std::int64_t stamp_ns = 0;
  std::vector<FeatureObservation> observations;
};

}  // namespace multicam_egomotion
