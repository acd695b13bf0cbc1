// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace multicam_egomotion {

/// What happened to the features in the last frame, and faults of the images since the start.
struct FeatureTrackerCounters {
  int tracked = 0;                    ///< features carried over from the previous frame
  int detected = 0;                   ///< new features
  int lost = 0;                       ///< features that ended
  int handed_over = 0;                ///< features that left one camera and live on in another
  int rejected_forward_backward = 0;  ///< temporal tracks that did not come back to where they started
  int reference_aligned = 0;          ///< tracked features aligned to their reference patch, hence without drift
  int cross_camera_matches = 0;       ///< observations of features by a second camera
  int rejected_epipolar = 0;          ///< earlier matches between cameras that failed in this frame
  std::uint64_t ignored_images = 0;   ///< unknown camera, repeated camera, wrong size or type; since the start

  /// Adds what happened in another part of the same frame.
  FeatureTrackerCounters& operator+=(const FeatureTrackerCounters& more) {
    tracked += more.tracked;
    detected += more.detected;
    lost += more.lost;
    handed_over += more.handed_over;
    rejected_forward_backward += more.rejected_forward_backward;
    reference_aligned += more.reference_aligned;
    cross_camera_matches += more.cross_camera_matches;
    rejected_epipolar += more.rejected_epipolar;
    ignored_images += more.ignored_images;
    return *this;
  }
};

}  // namespace multicam_egomotion
