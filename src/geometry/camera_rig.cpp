// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "multicam_egomotion/geometry/camera_rig.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "multicam_egomotion/geometry/rigid_transform.h"

namespace multicam_egomotion {
namespace {

constexpr double kMaxDistance = 100.0;  // [m] from the body
constexpr double kLeastOverlap = 0.05;
constexpr double kMaxTimeOffset = 10.0;  // [s]

// Checks the extrinsics and removes the rounding of the file from the rotation.
void makeRigid(RigCamera* camera) {
  const std::string name = "camera rig: T_body_cam of camera '" + camera->name + "' ";
  try {
    camera->T_body_cam = rigidTransform(camera->T_body_cam.matrix());
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(name + error.what());
  }
  const double distance = camera->T_body_cam.translation().norm();
  if (distance > kMaxDistance) {
    throw std::invalid_argument(name + "puts it " + std::to_string(distance) +
                                " m away from the body, expected at most 100 m (are these metres?)");
  }
}

// Share of the points on a grid over the image of `from`, at depths in geometric progression, seen by `to`.
double computeOverlap(const RigCamera& from, const RigCamera& to) {
  constexpr int kColumns = 32, kRows = 24;
  constexpr double kDepths[] = {2.0, 4.5, 10.0, 22.0, 50.0};  // [m]
  const Eigen::Isometry3d T_to_from = to.T_body_cam.inverse() * from.T_body_cam;
  int seen = 0, all = 0;
  for (int row = 0; row < kRows; ++row) {
    for (int column = 0; column < kColumns; ++column) {
      const Eigen::Vector2d pixel((column + 0.5) * from.model.width() / kColumns - 0.5,
                                  (row + 0.5) * from.model.height() / kRows - 0.5);
      Eigen::Vector3d bearing;
      if (!from.model.unproject(pixel, &bearing)) continue;
      for (const double depth : kDepths) {
        Eigen::Vector2d other;
        ++all;
        seen += to.model.project(T_to_from * (depth * bearing), &other) && to.model.contains(other);
      }
    }
  }
  return all > 0 ? static_cast<double>(seen) / all : 0.0;
}

}  // namespace

CameraRig::CameraRig(std::vector<RigCamera> cameras) : cameras_(std::move(cameras)) {
  if (cameras_.empty() || cameras_.size() > kMaxCameras) {
    throw std::invalid_argument("camera rig: number of cameras is " + std::to_string(cameras_.size()) +
                                ", expected 1 to " + std::to_string(kMaxCameras));
  }
  for (RigCamera& camera : cameras_) {
    makeRigid(&camera);
    if (!(std::abs(camera.time_offset_s) <= kMaxTimeOffset)) {
      throw std::invalid_argument("camera rig: time_offset_s of camera '" + camera.name + "' is " +
                                  std::to_string(camera.time_offset_s) + ", expected -10 to 10 s");
    }
  }

  const int n = size();
  overlap_.assign(n * n, 1.0);
  overlapping_.resize(n);
  for (int from = 0; from < n; ++from) {
    for (int to = 0; to < n; ++to) {
      if (to == from) continue;
      overlap_[from * n + to] = computeOverlap(cameras_[from], cameras_[to]);
      if (overlap(from, to) >= kLeastOverlap) overlapping_[from].push_back(to);
      const double distance = (cameras_[from].T_body_cam.translation() - cameras_[to].T_body_cam.translation()).norm();
      baseline_ = std::max(baseline_, distance);
    }
    std::stable_sort(overlapping_[from].begin(), overlapping_[from].end(),
                     [this, from](int a, int b) { return overlap(from, a) > overlap(from, b); });
  }
}

}  // namespace multicam_egomotion
