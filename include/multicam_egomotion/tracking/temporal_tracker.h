// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <vector>

#include "multicam_egomotion/geometry/camera_rig.h"
#include "multicam_egomotion/tracking/feature.h"
#include "multicam_egomotion/tracking/feature_regions.h"
#include "multicam_egomotion/tracking/feature_tracker_counters.h"
#include "multicam_egomotion/tracking/feature_tracker_options.h"
#include "multicam_egomotion/tracking/image_curvature.h"
#include "multicam_egomotion/tracking/optical_flow.h"

namespace multicam_egomotion {

/// The images of all cameras in the previous and the newest frame, and how they moved between.
struct FramePair {
  std::vector<FlowPyramid> previous, current;  ///< by camera; empty where the image was missing
  std::vector<Eigen::Isometry3d> previous_T_body_cam, T_body_cam;
  Eigen::Isometry3d T_cur_prev = Eigen::Isometry3d::Identity();  ///< of the body, predicted
  std::vector<double> epipolar_slack_px;                         ///< by camera, of matches with other cameras

  /// Of matches between two cameras [px].
  double slackBetween(int a, int b) const {
    return epipolar_slack_px.empty() ? 0.0 : std::hypot(epipolar_slack_px[a], epipolar_slack_px[b]);
  }
  /// From the optical frame of a camera at the previous frame to that of now.
  Eigen::Isometry3d motion(int camera) const {
    return T_body_cam[camera].inverse() * T_cur_prev * previous_T_body_cam[camera];
  }
};

/// Follows features of one camera from frame to frame: optical flow from the predicted position, then alignment to the
/// reference patch, or where that fails the way back.
class TemporalTracker {
 public:
  /// `rig` and `regions` must outlive this.
  TemporalTracker(const CameraRig& rig, const FeatureRegions& regions, const FeatureTrackerOptions& options);

  /// Tracks features that were seen in `camera` into its newest image. Those that are found are alive, and the camera
  /// owns them; returns how many. May run for several cameras at the same time, with features of their own.
  int track(const FramePair& frames, int camera, std::vector<Feature*> features, FeatureTrackerCounters* counters);

  /// Takes over how good the predictions of the frame were, for the next one.
  void endFrame();

  /// Takes the reference patch of a feature about `pixel` [px] of an image of `camera`; where there is no texture it
  /// has none then.
  void cutReference(int camera, const FlowPyramid& pyramid, const Eigen::Vector2d& pixel, Feature* feature) const;

  const OpticalFlowOptions& flow() const { return flow_; }

 private:
  int trackLevels(const FramePair& frames, int camera, int levels, const std::vector<Feature*>& features,
                  FeatureTrackerCounters* counters);
  Eigen::Vector2d predict(int camera, const Eigen::Isometry3d& T_cur_prev, const Feature& feature) const;
  bool advance(int camera, const Eigen::Vector2d& pixel, const Eigen::Isometry3d& T_cur_prev, Feature* feature) const;
  bool alignToReference(int camera, const FlowPyramid& pyramid, Feature* feature, Eigen::Vector2d* pixel) const;

  const CameraRig& rig_;
  const FeatureRegions& regions_;
  FeatureTrackerOptions options_;
  OpticalFlowOptions flow_;
  std::vector<ImageCurvature> curvatures_;  ///< by camera
  /// Error [px] that 9 of 10 predictions of the last frame stayed within, by camera.
  std::vector<double> max_prediction_error_;
  std::vector<std::vector<float>> prediction_errors_;
};

}  // namespace multicam_egomotion
