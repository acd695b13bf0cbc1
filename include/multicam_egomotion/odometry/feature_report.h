// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <unordered_set>
#include <vector>

#include "multicam_egomotion/odometry/ego_motion_result.h"
#include "multicam_egomotion/tracking/tracked_frame.h"

namespace multicam_egomotion {

/// The features of the newest frame with where they were in the previous one; both frames sorted by (track, camera).
std::vector<FeatureReport> reportFeatures(const TrackedFrame& previous, const TrackedFrame& newest,
                                          const std::unordered_set<TrackId>& inlier_tracks);

}  // namespace multicam_egomotion
