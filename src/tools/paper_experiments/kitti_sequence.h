// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <string>
#include <vector>

#include "multicam_egomotion/geometry/camera_rig.h"
#include "multicam_egomotion/tracking/frame_set.h"
#include "multicam_egomotion/tracking/tracked_frame.h"

namespace multicam_egomotion {

/// A sequence on disk: a folder of KITTI odometry (images), or one of feature tracks on a KITTI drive.
struct KittiFolder {
  std::string sequence;  ///< "00" to "10" where the drive is one of these, else the name of the drive
  std::string source;    ///< "images" or "tracks"
  std::string path;
};

/// The eleven sequences with ground truth.
const std::vector<std::string>& kittiSequenceNames();

/// Folders `sequences/NN` beside `poses/NN.txt`, and folders with tracks.csv, in `root` and the three levels below.
/// Sorted by sequence, the eleven first.
std::vector<KittiFolder> findKittiFolders(const std::string& root);

/// Stereo rig with ground truth. The body is the left camera, with the axes of REP-103; z of the world is its vertical:
/// up in the vehicle's first pose (tracks), up in the first image (images).
struct KittiSequence {
  KittiFolder folder;
  CameraRig rig;
  std::vector<std::int64_t> stamps_ns;
  std::vector<Eigen::Isometry3d> T_world_body;
  std::vector<TrackedFrame> frames;  ///< empty until tracked from the images

  std::vector<Eigen::Isometry3d> cameraPoses() const;
  Eigen::Vector3d up(std::size_t frame) const { return T_world_body[frame].linear().transpose().col(2); }
  /// T_f2_f1 between a frame and the next.
  Eigen::Isometry3d motion(std::size_t frame) const { return T_world_body[frame + 1].inverse() * T_world_body[frame]; }
};

/// At most `frames` frames (0: all). Throws std::runtime_error on a file that is not as expected.
KittiSequence loadKittiSequence(const KittiFolder& folder, int frames);

/// Both images of a frame; throws std::runtime_error when one cannot be read.
FrameSet kittiImages(const KittiSequence& sequence, std::size_t frame);

}  // namespace multicam_egomotion
