// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <vector>

#include "multicam_egomotion/geometry/camera_rig.h"
#include "multicam_egomotion/tracking/image_point.h"
#include "multicam_egomotion/tracking/patch_alignment.h"

namespace multicam_egomotion {

/// Grey image pyramid: level l is scaled by 2^-l, pixel x of level 0 lies at x / 2^l.
using ImagePyramid = std::vector<cv::Mat>;

struct CrossCameraOptions {
  int patch_size_px = 15;
  int search_level = 2;         ///< pyramid level of the search along the epipolar curve
  double min_distance_m = 0.3;  ///< nearest point searched for
  double max_epipolar_error_px = 1.5;
  double max_reverse_error_px = 0.7;  ///< of the match carried back into the first image
  double min_correlation = 0.75;      ///< at the finest level
  double min_distinction = 0.03;      ///< correlation by which the best match must beat any other along the curve
};

struct CrossCameraMatch {
  ImagePoint point;               ///< in the second camera
  double inverse_distance = 0.0;  ///< along the bearing in the first camera [1/m], at least 0
};

/// Finds features of one camera in the image of another that looks at the same scene at the same time. Patches are
/// warped by the local map between the two images, so the cameras may be turned or of different models.
class CrossCameraMatcher {
 public:
  CrossCameraMatcher(const CameraRig& rig, const CrossCameraOptions& options);

  /// One ordered pair of images.
  struct Pair {
    int from = 0;
    int to = 0;
    const ImagePyramid& from_image;
    const ImagePyramid& to_image;
    Eigen::Isometry3d T_to_from;
    double epipolar_slack_px = 0.0;  ///< matches may be so much further off their lines: T_to_from is not known well
  };

  /// Searches along the whole epipolar curve.
  std::optional<CrossCameraMatch> search(const Pair& pair, const ImagePoint& point) const;

  /// Refines from a known inverse distance [1/m] of the previous frame. `model`:
  /// what is estimated in the finest image.
  std::optional<CrossCameraMatch> rematch(const Pair& pair, const ImagePoint& point, double inverse_distance,
                                          WarpModel model = WarpModel::kTranslation) const;

 private:
  struct Candidate {
    double inverse_distance;
    double correlation;
  };

  bool warpAt(const Pair& pair, const ImagePoint& point, double inverse_distance, PatchWarp* warp) const;
  Eigen::Matrix<double, 2, 3> inverseCurvature(const Pair& pair, const ImagePoint& point, double inverse_distance,
                                               const Eigen::Vector2d& pixel) const;
  bool refine(const Pair& pair, const ImagePoint& point, double inverse_distance, int first_level, WarpModel model,
              CrossCameraMatch* match, double* correlation) const;
  bool reverses(const Pair& pair, const ImagePoint& point, const CrossCameraMatch& match) const;
  void collectCandidates(const Pair& pair, const ImagePoint& point, std::vector<Candidate>* candidates) const;

  const CameraRig& rig_;
  CrossCameraOptions options_;
};

}  // namespace multicam_egomotion
