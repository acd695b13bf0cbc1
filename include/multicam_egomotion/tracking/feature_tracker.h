// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "multicam_egomotion/geometry/camera_rig.h"
#include "multicam_egomotion/tracking/feature_tracker_counters.h"
#include "multicam_egomotion/tracking/feature_tracker_options.h"
#include "multicam_egomotion/tracking/frame_set.h"
#include "multicam_egomotion/tracking/tracked_frame.h"

namespace multicam_egomotion {

/// Corner features of all cameras of a rig, tracked in time and across overlapping cameras.
///
/// A feature belongs to one camera, in which it is tracked from frame to frame by pyramidal Lucas-Kanade (Bouguet 2001)
/// from a predicted position and then aligned to its reference patch, so that it does not drift; in each frame it is
/// matched from there into the overlapping cameras. When it leaves its camera it lives on in one of those, or with
/// resume() in any that comes to see it later.
/// Cameras are worked on at the same time (cv::parallel_for_). Deterministic on any number of threads; never throws on
/// images.
class FeatureTracker {
 public:
  /// Throws std::invalid_argument (name, found, expected) on options that cannot be.
  FeatureTracker(const CameraRig& rig, const FeatureTrackerOptions& options);
  ~FeatureTracker();
  FeatureTracker(FeatureTracker&&) noexcept;
  FeatureTracker& operator=(FeatureTracker&&) noexcept;

  /// Image regions to ignore: CV_8UC1 of the camera's size, 0 = ignore; empty: none.
  /// Throws std::invalid_argument on another size or type or a camera that does not exist.
  void setMask(int camera, const cv::Mat& mask);

  /// Takes features_per_camera and fast_threshold of `options` from the next frame on, ends the newest of too many
  /// features; the other options stay. Throws as the constructor and then changes nothing.
  void setDetection(const FeatureTrackerOptions& options);

  /// Tracks all features into `frames` and detects new ones where they are missing. A camera without an image loses its
  /// features. The images are copied.
  /// `T_prev_cur`: predicted motion, body at this frame in the body at the previous one; identity when unknown.
  /// `T_body_cam`: pose of each camera of the rig at the time of its own image in the body at the reference stamp.
  TrackedFrame track(const FrameSet& frames, const Eigen::Isometry3d& T_prev_cur,
                     const std::vector<Eigen::Isometry3d>& T_body_cam);

  /// How much further off their epipolar lines matches with each camera may be from now on [px]: its rotation is not
  /// known well. Empty: none.
  void setEpipolarSlack(const std::vector<double>& slack_px);

  /// Looks for features that left their camera where others should see them in the newest frame. What is found is
  /// tracked on from the next frame, as the same track. `points`: where tracks are that the frame does not have; what
  /// is not among them, or left in a frame without this call, is forgotten. `T_prev_cur`: as for track(), estimated.
  void resume(const std::vector<TrackedPoint>& points, const Eigen::Isometry3d& T_prev_cur);

  /// The newest frame becomes the reference of the patches of all its features.
  void markKeyframe();

  /// Ends tracks, for example those that the estimation found to be outliers.
  void remove(const std::vector<TrackId>& tracks);

  /// Forgets all features and images; masks and counters stay, track ids are not used again.
  void reset();

  const FeatureTrackerCounters& counters() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace multicam_egomotion
