// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <fstream>
#include <string>
#include <vector>

namespace multicam_egomotion {

/// TUM trajectory: `stamp x y z qx qy qz qw`, body in odom; stamps with 9 decimals, exact to the nanosecond.
class TumFile {
 public:
  explicit TumFile(const std::string& path);  ///< throws std::runtime_error
  void write(std::int64_t stamp_ns, const Eigen::Isometry3d& T_odom_body);
  void close();  ///< throws std::runtime_error when not everything could be written

 private:
  std::string path_;
  std::ofstream file_;
};

/// KITTI poses: one line an image of camera 0, camera 0 relative to its first pose; the identity until then, the last
/// pose where an image has none.
class KittiFile {
 public:
  KittiFile(const std::string& path, const Eigen::Isometry3d& T_body_cam0);  ///< throws std::runtime_error
  void addImage(std::int64_t stamp_ns) { image_stamps_ns_.push_back(stamp_ns); }
  /// Pose of the image of camera 0 with this stamp.
  void addPose(std::int64_t image_stamp_ns, const Eigen::Isometry3d& T_odom_body);
  void close();  ///< writes everything; throws std::runtime_error

 private:
  std::string path_;
  std::ofstream file_;
  Eigen::Isometry3d T_body_cam0_;
  std::vector<std::int64_t> image_stamps_ns_;
  std::vector<std::pair<std::int64_t, Eigen::Isometry3d>> poses_;  // T_odom_cam0 by image stamp
};

}  // namespace multicam_egomotion
