// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "multicam_egomotion/geometry/camera_rig.h"
#include "multicam_egomotion/tracking/image_point.h"

namespace multicam_egomotion {

/// Compares the calibrated rotation between two cameras with what both see at the same time: matches that lie off
/// their epipolar lines as a turn of one camera would move them show a wrong mounting. A turn along the lines
/// (vergence) cannot be told from another distance of the points.
class CalibrationCheck {
 public:
  explicit CalibrationCheck(const CameraRig& rig) : rig_(rig) {}

  /// A pair of points that look alike, in cameras `a` and `b` at the same time, on their epipolar lines or not.
  /// `T_b_a`: as calibrated, the optical frame of a into that of b.
  void add(int a, const ImagePoint& in_a, int b, const ImagePoint& in_b, const Eigen::Isometry3d& T_b_a);

  /// After all pairs of a frame: lets what is older fade.
  void endFrame();

  struct Turn {
    double angle = 0.0;         ///< of the smallest rotation that explains the errors [rad]
    double explained_px = 0.0;  ///< RMS distance from the epipolar lines that it makes
    double left_px = 0.0;       ///< RMS distance that it does not explain
  };
  /// By which camera b seems to be turned against a; nothing where they have hardly seen the same.
  std::optional<Turn> turn(int a, int b) const;

  /// One line for each two cameras that contradict their calibration.
  std::vector<std::string> faults() const;

 private:
  // Of the errors e + g · turn: weighted sums.
  struct Sums {
    Eigen::Matrix3d gg = Eigen::Matrix3d::Zero();
    Eigen::Vector3d ge = Eigen::Vector3d::Zero();
    double ee = 0.0, weight = 0.0, count = 0.0;
  };

  const CameraRig& rig_;
  std::map<std::pair<int, int>, Sums> pairs_;  ///< by camera, the lower first
};

}  // namespace multicam_egomotion
