// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "simulator/scene.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "simulator/random.h"

namespace multicam_egomotion {

namespace {

constexpr int kTextureSize = 2048;
constexpr double kFineTexel = 0.003;   // [m]; repeats every 6 m
constexpr double kCoarseTexel = 0.03;  // [m]; repeats every 60 m
constexpr int kFineTextures = 3;
constexpr int kTextures = 5;
constexpr float kFineWeight = 0.52f, kCoarseWeight = 0.60f;
constexpr float kSky = 215.0f;

}  // namespace

Scene::Scene(const Box& hall, const std::vector<Box>& boxes, bool open_sky, std::uint64_t seed) : open_sky_(open_sky) {
  boxes_.push_back(hall);
  boxes_.insert(boxes_.end(), boxes.begin(), boxes.end());
  for (const Box& box : boxes_) frames_.push_back({std::cos(box.yaw), std::sin(box.yaw), box.half_size.norm()});
  for (int i = 1; i < static_cast<int>(boxes_.size()); ++i) all_boxes_.push_back(i);
  for (int i = 0; i < kTextures; ++i) textures_.push_back(std::make_shared<Texture>(kTextureSize, 31 * seed + i));
  Random random(seed, 11);
  for (std::size_t i = 0; i < 6 * boxes_.size(); ++i) {
    const float turn = static_cast<float>(random.uniform(0.0, 2.0 * M_PI));
    Surface surface;
    surface.cos_turn = std::cos(turn);
    surface.sin_turn = std::sin(turn);
    surface.shift_u = static_cast<float>(random.uniform(0.0, 60.0));
    surface.shift_v = static_cast<float>(random.uniform(0.0, 60.0));
    surface.brightness = static_cast<float>(random.uniform(-35.0, 35.0));
    surface.fine = random.index(kFineTextures);
    surface.coarse = kFineTextures + random.index(kTextures - kFineTextures);
    surfaces_.push_back(surface);
  }
}

SceneHit Scene::castRay(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) const {
  return castRay(origin, direction, all_boxes_);
}

SceneHit Scene::castRay(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
                        const std::vector<int>& candidates) const {
  SceneHit hit;
  hit.distance = std::numeric_limits<double>::infinity();
  int hit_box = -1, hit_axis = 0;
  double hit_side = 0.0;
  // Slabs (Kay, Kajiya, SIGGRAPH 1986): the entry of a box, the exit of the hall.
  const auto test = [&](int index) {
    const Box& box = boxes_[index];
    const Frame& frame = frames_[index];
    const Eigen::Vector3d offset = origin - box.center;
    const double o[3] = {frame.cos_yaw * offset.x() + frame.sin_yaw * offset.y(),
                         frame.cos_yaw * offset.y() - frame.sin_yaw * offset.x(), offset.z()};
    const double d[3] = {frame.cos_yaw * direction.x() + frame.sin_yaw * direction.y(),
                         frame.cos_yaw * direction.y() - frame.sin_yaw * direction.x(), direction.z()};
    double enter = -std::numeric_limits<double>::infinity(), leave = -enter;
    int enter_axis = 0, leave_axis = 0;
    for (int axis = 0; axis < 3; ++axis) {
      if (d[axis] == 0.0) {
        if (std::abs(o[axis]) > box.half_size[axis]) return;
        continue;
      }
      const double inverse = 1.0 / d[axis];
      const double middle = -o[axis] * inverse, reach = box.half_size[axis] * std::abs(inverse);
      if (middle - reach > enter) enter = middle - reach, enter_axis = axis;
      if (middle + reach < leave) leave = middle + reach, leave_axis = axis;
    }
    if (enter > leave) return;
    const bool inside = index == 0;
    const double distance = inside ? leave : enter;
    if (!(distance > 0.0) || distance >= hit.distance) return;
    hit.distance = distance;
    hit_box = index;
    hit_axis = inside ? leave_axis : enter_axis;
    hit_side = (d[hit_axis] > 0.0) == inside ? 1.0 : -1.0;
  };
  test(0);
  if (open_sky_ && hit_box == 0 && hit_axis == 2 && hit_side > 0.0) {
    hit_box = -1;
    hit.distance = std::numeric_limits<double>::infinity();
  }
  for (const int index : candidates) test(index);
  if (hit_box < 0) return hit;
  hit.surface = 6 * hit_box + 2 * hit_axis + (hit_side > 0.0 ? 1 : 0);
  const Frame& frame = frames_[hit_box];
  if (hit_axis == 0) hit.normal << frame.cos_yaw, frame.sin_yaw, 0.0;
  if (hit_axis == 1) hit.normal << -frame.sin_yaw, frame.cos_yaw, 0.0;
  if (hit_axis == 2) hit.normal << 0.0, 0.0, 1.0;
  return hit;
}

void Scene::boxesInCone(const Eigen::Vector3d& origin, const Eigen::Vector3d& axis, double half_angle,
                        std::vector<int>* boxes) const {
  boxes->clear();
  for (int i = 1; i < static_cast<int>(boxes_.size()); ++i) {
    const Eigen::Vector3d to_box = boxes_[i].center - origin;
    const double distance = to_box.norm();
    if (distance > frames_[i].radius) {
      const double angle = std::acos(std::max(-1.0, std::min(1.0, axis.dot(to_box) / distance)));
      if (angle > half_angle + std::asin(frames_[i].radius / distance)) continue;
    }
    boxes->push_back(i);
  }
}

float Scene::shade(const SceneHit& hit, const Eigen::Vector3d& point, const Eigen::Vector3d& edge_u,
                   const Eigen::Vector3d& edge_v) const {
  if (hit.surface < 0) return kSky;
  const int box = hit.surface / 6, axis = hit.surface % 6 / 2;
  const Frame& frame = frames_[box];
  const Surface& surface = surfaces_[hit.surface];
  // Coordinates on the face [m], then turned and shifted differently on each.
  const auto onFace = [&](const Eigen::Vector3d& p, float* u, float* v) {
    const double x = frame.cos_yaw * p.x() + frame.sin_yaw * p.y();
    const double y = frame.cos_yaw * p.y() - frame.sin_yaw * p.x();
    const float a = static_cast<float>(axis == 0 ? y : x), b = static_cast<float>(axis == 2 ? y : p.z());
    *u = surface.cos_turn * a - surface.sin_turn * b;
    *v = surface.sin_turn * a + surface.cos_turn * b;
  };
  float u, v, u1, v1, u2, v2;
  onFace(point - boxes_[box].center, &u, &v);
  onFace(edge_u, &u1, &v1);
  onFace(edge_v, &u2, &v2);
  u += surface.shift_u;
  v += surface.shift_v;

  // Two samples across the shorter edge and as many along the longer one as the pixel is slanted, each smoothed over
  // its share: half a pixel at most, so that bilinear interpolation leaves no bias within the pixel.
  float length1 = std::sqrt(u1 * u1 + v1 * v1), length2 = std::sqrt(u2 * u2 + v2 * v2);
  if (length1 < length2) {
    std::swap(length1, length2);
    std::swap(u1, u2);
    std::swap(v1, v2);
  }
  const float width = std::max(std::abs(u1 * v2 - u2 * v1) / std::max(length1, 1e-9f), 1e-9f);
  const int count = std::max(2, std::min(16, static_cast<int>(std::ceil(1.2f * length1 / width))));
  const float footprint = std::max(0.5f * width, length1 / count);
  constexpr float kToFine = static_cast<float>(1.0 / kFineTexel), kToCoarse = static_cast<float>(1.0 / kCoarseTexel);
  const Texture& fine = *textures_[surface.fine];
  const Texture& coarse = *textures_[surface.coarse];
  const Texture::Level fine_level = fine.levelFor(footprint * kToFine);
  const Texture::Level coarse_level = coarse.levelFor(footprint * kToCoarse);
  // Near by, the coarse texture does not change within the pixel.
  const bool coarse_once = length1 * kToCoarse < 0.4f;
  float fine_sum = 0.0f, coarse_sum = 0.0f;
  for (int i = 0; i < count; ++i) {
    const float along = (i + 0.5f) / count - 0.5f;
    for (const float across : {-0.25f, 0.25f}) {
      const float su = u + along * u1 + across * u2, sv = v + along * v1 + across * v2;
      fine_sum += fine.sample(su * kToFine, sv * kToFine, fine_level);
      if (!coarse_once) coarse_sum += coarse.sample(su * kToCoarse, sv * kToCoarse, coarse_level);
    }
  }
  const float fine_mean = fine_sum / (2 * count);
  const float coarse_mean =
      coarse_once ? coarse.sample(u * kToCoarse, v * kToCoarse, coarse_level) : coarse_sum / (2 * count);
  const float grey = kFineWeight * fine_mean + kCoarseWeight * coarse_mean + surface.brightness - 16.0f;
  return std::max(12.0f, std::min(243.0f, grey));
}

}  // namespace multicam_egomotion
