// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "multicam_egomotion/tracking/corner_detector.h"
#include "multicam_egomotion/tracking/cross_camera_matcher.h"
#include "multicam_egomotion/tracking/optical_flow.h"

namespace multicam_egomotion {

struct FeatureTrackerOptions {
  int features_per_camera = 150;
  int min_distance_px = 12;                    ///< between new features and the others of the same image
  int fast_threshold = 10;                     ///< FAST corner threshold [grey levels]
  int patch_size_px = 15;                      ///< side of the square patch that is tracked, odd, 7 to 21
  int pyramid_levels = 4;                      ///< 1: full resolution only; 1 to 6
  double max_forward_backward_error_px = 0.7;  ///< of a patch tracked there and back
  double max_reference_correction_px = 1.0;    ///< by which alignment to the reference patch may move a feature
  double max_epipolar_error_px = 1.5;          ///< of matches between cameras
  double min_distance_m = 0.3;                 ///< nearest point looked for by matching between cameras
};

/// Throws std::invalid_argument (name, found, expected) on a value that cannot be.
void check(const FeatureTrackerOptions& options);

/// The options of the tracker's parts.
OpticalFlowOptions opticalFlowOptions(const FeatureTrackerOptions& options);
CrossCameraOptions crossCameraOptions(const FeatureTrackerOptions& options);
CornerDetectorOptions cornerDetectorOptions(const FeatureTrackerOptions& options);

}  // namespace multicam_egomotion
