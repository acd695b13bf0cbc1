// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <vector>

namespace multicam_egomotion {

/// One grey image of one camera.
struct CameraImage {
  int camera = 0;             ///< index in the rig
  std::int64_t stamp_ns = 0;  ///< the image's own stamp (camera clock)
  cv::Mat grey;               ///< CV_8UC1, the size of the camera's model
};

/// Images of one instant, sorted by camera, at most one a camera (contracts 1 and 2).
struct FrameSet {
  std::int64_t stamp_ns = 0;        ///< reference stamp: that of the lowest-numbered live camera
  std::vector<CameraImage> images;  ///< a camera that is missing has no entry
};

}  // namespace multicam_egomotion
