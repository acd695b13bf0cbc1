// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "multicam_egomotion/tracking/feature_tracker_options.h"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "multicam_egomotion/tracking/patch_alignment.h"

namespace multicam_egomotion {
namespace {

void require(bool valid, const char* name, double found, const char* expected) {
  if (!valid) {
    throw std::invalid_argument(std::string("tracker ") + name + ": found " + std::to_string(found) + ", expected " +
                                expected);
  }
}

}  // namespace

void check(const FeatureTrackerOptions& o) {
  require(o.features_per_camera >= 1 && o.features_per_camera <= 10000, "features_per_camera", o.features_per_camera,
          "1 to 10000");
  require(o.min_distance_px >= 1 && o.min_distance_px <= 500, "min_distance_px", o.min_distance_px, "1 to 500");
  require(o.fast_threshold >= 1 && o.fast_threshold <= 254, "fast_threshold", o.fast_threshold, "1 to 254");
  require(o.patch_size_px >= 7 && o.patch_size_px <= PatchTemplate::kMaxSize && o.patch_size_px % 2 == 1,
          "patch_size_px", o.patch_size_px, "odd, 7 to 21");
  require(o.pyramid_levels >= 1 && o.pyramid_levels <= 6, "pyramid_levels", o.pyramid_levels, "1 to 6");
  require(o.max_forward_backward_error_px > 0, "max_forward_backward_error_px", o.max_forward_backward_error_px, "> 0");
  require(o.max_reference_correction_px >= 0, "max_reference_correction_px", o.max_reference_correction_px, ">= 0");
  require(o.max_epipolar_error_px > 0, "max_epipolar_error_px", o.max_epipolar_error_px, "> 0");
  require(o.min_distance_m > 0, "min_distance_m", o.min_distance_m, "> 0");
}

OpticalFlowOptions opticalFlowOptions(const FeatureTrackerOptions& options) {
  OpticalFlowOptions flow;
  flow.patch_size_px = options.patch_size_px;
  flow.pyramid_levels = options.pyramid_levels;
  flow.max_forward_backward_error_px = options.max_forward_backward_error_px;
  return flow;
}

CrossCameraOptions crossCameraOptions(const FeatureTrackerOptions& options) {
  CrossCameraOptions cross;
  cross.patch_size_px = options.patch_size_px;
  cross.search_level = std::min(cross.search_level, options.pyramid_levels - 1);
  cross.min_distance_m = options.min_distance_m;
  cross.max_epipolar_error_px = options.max_epipolar_error_px;
  cross.max_reverse_error_px = options.max_forward_backward_error_px;
  return cross;
}

CornerDetectorOptions cornerDetectorOptions(const FeatureTrackerOptions& options) {
  CornerDetectorOptions corners;
  corners.features = options.features_per_camera;
  corners.min_distance_px = options.min_distance_px;
  corners.fast_threshold = options.fast_threshold;
  corners.border_px = options.patch_size_px / 2 + 2;
  return corners;
}

}  // namespace multicam_egomotion
