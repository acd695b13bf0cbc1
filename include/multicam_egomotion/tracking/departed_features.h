// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <map>
#include <vector>

#include "multicam_egomotion/tracking/cross_camera_matcher.h"
#include "multicam_egomotion/tracking/feature.h"
#include "multicam_egomotion/tracking/feature_regions.h"
#include "multicam_egomotion/tracking/temporal_tracker.h"

namespace multicam_egomotion {

/// Features that left the camera in which they were tracked, with what they looked like, until another camera comes to
/// see them: what leaves the view ahead of a vehicle passes by its side. Cameras need not overlap for that.
class DepartedFeatures {
 public:
  /// All must outlive this.
  DepartedFeatures(const CameraRig& rig, const FeatureRegions& regions, const CrossCameraMatcher& matcher)
      : rig_(rig), regions_(regions), matcher_(matcher) {}

  /// Adds a feature of the previous frame that its owner has lost in the newest one.
  void add(const FramePair& frames, const Feature& feature);

  /// Looks in the newest images for those whose points are known, and forgets the others; what is found has not
  /// departed any more. Call it once a frame, after all have been added. `T_cur_prev`: the previous body in the newest
  /// one.
  std::vector<Feature> find(const std::vector<TrackedPoint>& points, const Eigen::Isometry3d& T_cur_prev,
                            const FramePair& frames);

  void clear() { departed_.clear(); }

 private:
  struct Departed {
    int camera = 0;
    ImagePoint point;              ///< in its last view; the pixel is one of `image`
    ImagePyramid image;            ///< surroundings of the point
    Eigen::Isometry3d T_body_cam;  ///< of the last view, in the newest body frame
  };

  bool findIn(int camera, const Departed& departed, const TrackedPoint& point, const FramePair& frames,
              Feature* feature) const;

  const CameraRig& rig_;
  const FeatureRegions& regions_;
  const CrossCameraMatcher& matcher_;
  std::map<TrackId, Departed> departed_;
};

}  // namespace multicam_egomotion
