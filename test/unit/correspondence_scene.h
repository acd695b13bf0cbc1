// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <random>
#include <vector>

#include "multicam_egomotion/estimation/correspondence_set.h"
#include "multicam_egomotion/geometry/so3.h"

namespace multicam_egomotion {

/// A motion with a bit of everything: rotation vector [rad] and translation [m] of T_f2_f1.
inline const Eigen::Vector3d kRotation(0.02, -0.03, 0.08), kTranslation(-0.4, 0.1, 0.05);

/// Two frames of a rig of bearing cameras with known motion T_f2_f1 = [R t].
struct CorrespondenceScene {
  static constexpr double kFocalLength = 400.0;  ///< [px/rad]

  std::vector<Eigen::Isometry3d> T_body_cam;
  std::vector<Eigen::Vector3d> centers;
  Eigen::Matrix3d R;
  Eigen::Vector3d t;
  std::vector<CorrespondenceSet::Entry> entries;
  std::vector<char> outlier;
  std::vector<Eigen::Vector2d> noise1_px, noise2_px;  ///< image noise of each entry, along two tangents
  std::vector<Eigen::Vector3d> true1, true2;          ///< directions without noise, body axes

  CorrespondenceSet set() const { return CorrespondenceSet(entries, centers, centers); }
};

/// Rigs that look in different directions: `yaws` of the cameras [rad] at these centres; a camera is told to overlap
/// another when both look the same way.
struct RigShape {
  std::vector<double> yaws;
  std::vector<Eigen::Vector3d> centers;
};

inline RigShape stereoShape() { return {{0.0, 0.0}, {{0.1, 0.06, 0.0}, {0.1, -0.06, 0.0}}}; }
inline RigShape surroundShape() {
  return {{0.0, 1.57, 3.14, -1.57}, {{2.0, 0.0, 1.0}, {1.0, 0.9, 1.0}, {-0.5, 0.0, 1.0}, {1.0, -0.9, 1.0}}};
}
inline RigShape monoShape() { return {{0.0}, {{0.1, 0.0, 0.05}}}; }

/// `count` points over all cameras 3 to 25 m away; every camera that sees the point in the second frame gives one more
/// correspondence (cross-camera where cameras look the same way). Outliers have a random second direction.
inline CorrespondenceScene makeCorrespondenceScene(const RigShape& rig, const Eigen::Vector3d& rotation_vector,
                                                   const Eigen::Vector3d& t, int count, double sigma_px,
                                                   double outlier_share, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  CorrespondenceScene scene;
  scene.R = expSO3(rotation_vector);
  scene.t = t;
  for (std::size_t i = 0; i < rig.yaws.size(); ++i) {
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    T.linear() = expSO3({0.0, 0.0, rig.yaws[i]});  // the camera looks along its x
    T.translation() = rig.centers[i];
    scene.T_body_cam.push_back(T);
    scene.centers.push_back(rig.centers[i]);
  }
  const auto view = [&](int camera, const Eigen::Vector3d& point, Eigen::Vector3d* direction) {
    const Eigen::Vector3d x = scene.T_body_cam[camera].inverse() * point;
    *direction = (point - scene.centers[camera]).normalized();
    return x.x() > 0.2 && std::abs(x.y()) < 0.9 * x.x() && std::abs(x.z()) < 0.7 * x.x();
  };
  const auto disturb = [&](const Eigen::Vector3d& direction, Eigen::Vector2d* noise) {
    *noise = sigma_px * Eigen::Vector2d(normal(random), normal(random));
    const Eigen::Vector3d u = direction.unitOrthogonal(), v = direction.cross(u);
    return Eigen::Vector3d(
        (direction + (noise->x() * u + noise->y() * v) / CorrespondenceScene::kFocalLength).normalized());
  };
  const int cameras = static_cast<int>(rig.yaws.size());
  int made = 0;
  while (made < count) {
    const int camera = made % cameras;
    const double range = uniform(3.0, 25.0);
    const Eigen::Vector3d local(range, range * uniform(-0.8, 0.8), range * uniform(-0.6, 0.6));
    const Eigen::Vector3d point = scene.T_body_cam[camera] * local;
    const Eigen::Vector3d moved = scene.R * point + scene.t;
    Eigen::Vector3d first, second;
    if (!view(camera, point, &first) || !view(camera, moved, &second)) continue;
    ++made;
    const bool wrong = uniform(0.0, 1.0) < outlier_share;
    for (int other = 0; other < cameras; ++other) {
      if (!view(other, moved, &second)) continue;
      Eigen::Vector2d noise1, noise2;
      CorrespondenceSet::Entry entry;
      Eigen::Vector3d seen = second;
      if (wrong) {
        seen = scene.T_body_cam[other].linear() *
               Eigen::Vector3d(1.0, uniform(-0.8, 0.8), uniform(-0.6, 0.6)).normalized();
      }
      entry.rays.first = makeRay(disturb(first, &noise1), scene.centers[camera]);
      entry.rays.second = makeRay(disturb(seen, &noise2), scene.centers[other]);
      entry.rays.camera1 = camera;
      entry.rays.camera2 = other;
      entry.pixels_per_radian1 = entry.pixels_per_radian2 = CorrespondenceScene::kFocalLength;
      scene.entries.push_back(entry);
      scene.outlier.push_back(wrong);
      scene.noise1_px.push_back(noise1);
      scene.noise2_px.push_back(noise2);
      scene.true1.push_back(first);
      scene.true2.push_back(second);
    }
  }
  return scene;
}

}  // namespace multicam_egomotion
