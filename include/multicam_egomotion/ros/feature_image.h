// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core/mat.hpp>

#include "multicam_egomotion/geometry/camera_rig.h"
#include "multicam_egomotion/ros/recent_images.h"

namespace multicam_egomotion {

/// The images of a frame set, at most two cameras a row, with its tracks: inliers green, outliers red, new features
/// blue; the line goes back to the previous frame. BGR; a camera without an image stays black.
cv::Mat drawFeatures(const EgoMotionResult& result, const CameraRig& rig, const RecentImages& images);

}  // namespace multicam_egomotion
