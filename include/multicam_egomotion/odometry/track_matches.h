// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "multicam_egomotion/estimation/correspondence_set.h"
#include "multicam_egomotion/tracking/tracked_frame.h"

namespace multicam_egomotion {

/// One frame's features with the camera poses of that moment (stamp differences applied, contract 2).
struct PosedFrame {
  TrackedFrame frame;
  std::vector<Eigen::Isometry3d> T_body_cam;
  std::vector<double> turn_sigma_px;  ///< by camera, of its rotation in the body; empty: all are exact
};

/// What two frames see of the same tracks.
struct TrackMatches {
  CorrespondenceSet set;
  std::vector<TrackId> tracks;  ///< by correspondence, sorted
  std::vector<double>
      parallax_px;  ///< by correspondence: image motion with R_f2_f1 taken out; negative between cameras
};

/// All pairs of views, of one camera or of two, of each track that both frames see; of two only where both are turned
/// as T_body_cam says to `max_turn_sigma_px`.
TrackMatches matchTracks(const PosedFrame& previous, const PosedFrame& newest, const Eigen::Matrix3d& R_f2_f1,
                         double max_turn_sigma_px = 0.0);

}  // namespace multicam_egomotion
