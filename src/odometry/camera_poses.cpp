// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "multicam_egomotion/odometry/camera_poses.h"

#include <cmath>

#include "multicam_egomotion/geometry/so3.h"

namespace multicam_egomotion {

std::vector<Eigen::Isometry3d> cameraPoses(const CameraRig& rig, const FrameSet& set, std::int64_t reference_ns,
                                           const TwistWithCovariance& twist) {
  std::vector<Eigen::Isometry3d> poses;
  for (const RigCamera& camera : rig.cameras()) poses.push_back(camera.T_body_cam);
  for (const CameraImage& image : set.images) {
    const std::int64_t offset_ns = std::llround(rig.camera(image.camera).time_offset_s * 1e9);
    const double dt = 1e-9 * static_cast<double>(image.stamp_ns + offset_ns - reference_ns);
    Eigen::Isometry3d T_reference_image = Eigen::Isometry3d::Identity();
    T_reference_image.linear() = expSO3(twist.angular * dt);
    T_reference_image.translation() = twist.linear * dt;
    poses[image.camera] = T_reference_image * poses[image.camera];
  }
  return poses;
}

}  // namespace multicam_egomotion
