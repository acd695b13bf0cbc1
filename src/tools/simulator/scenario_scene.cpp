// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "simulator/scenario_scene.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "simulator/random.h"

namespace multicam_egomotion {

namespace {

/// The first minute is part of every scene, so that shorter runs share it.
std::vector<Eigen::Vector3d> samplePath(const Trajectory& trajectory, double duration_s) {
  std::vector<Eigen::Vector3d> path;
  for (double t = -1.0; t <= std::max(60.0, duration_s) + 1.0; t += 0.1) {
    path.push_back(trajectory.at(t).T_world_body.translation());
  }
  return path;
}

double horizontalDistance(const Scene::Box& box, const Eigen::Vector3d& point) {
  const Eigen::Vector3d offset = Eigen::AngleAxisd(-box.yaw, Eigen::Vector3d::UnitZ()) * (point - box.center);
  const double dx = std::max(0.0, std::abs(offset.x()) - box.half_size.x());
  const double dy = std::max(0.0, std::abs(offset.y()) - box.half_size.y());
  return std::hypot(dx, dy);
}

}  // namespace

std::shared_ptr<const Scene> makeScene(const SceneDescription& description, const Trajectory& trajectory,
                                       double duration_s, std::uint64_t seed) {
  const std::vector<Eigen::Vector3d> path = samplePath(trajectory, duration_s);
  Eigen::Vector3d low = path.front(), high = path.front();
  for (const Eigen::Vector3d& point : path) {
    low = low.cwiseMin(point);
    high = high.cwiseMax(point);
  }
  low -= Eigen::Vector3d::Constant(description.margin);
  high += Eigen::Vector3d::Constant(description.margin);
  low.z() = description.floor;
  high.z() = description.floor + description.height;
  const Scene::Box hall{0.5 * (low + high), 0.5 * (high - low), 0.0};

  Random random(seed, 5);
  const double area = (high.x() - low.x()) * (high.y() - low.y());
  const int wanted = static_cast<int>(std::lround(description.box_density * area));
  std::vector<Scene::Box> boxes;
  for (int attempt = 0; attempt < 50 * wanted && static_cast<int>(boxes.size()) < wanted; ++attempt) {
    Scene::Box box;
    for (int axis = 0; axis < 3; ++axis) {
      // More small ones than large ones.
      const double share = random.uniform();
      box.half_size[axis] =
          0.5 * (description.min_side + (description.max_side - description.min_side) * share * share);
    }
    box.half_size.z() = std::min(box.half_size.z() * random.uniform(0.7, 1.8), 0.48 * description.height);
    box.center = {random.uniform(low.x(), high.x()), random.uniform(low.y(), high.y()), 0.0};
    box.yaw = random.uniform(0.0, M_PI);
    // Most stand on the floor, some hang, as lamps, shelves and signs do.
    const double top = high.z() - box.half_size.z(), bottom = low.z() + box.half_size.z();
    const bool hangs = random.uniform() < 0.3;
    box.center.z() = hangs ? random.uniform(bottom, top) : bottom;
    const bool clear = std::all_of(path.begin(), path.end(), [&](const Eigen::Vector3d& point) {
      return horizontalDistance(box, point) > description.clearance;
    });
    if (clear) boxes.push_back(box);
  }
  return std::make_shared<Scene>(hall, boxes, description.open_sky, seed);
}

}  // namespace multicam_egomotion
