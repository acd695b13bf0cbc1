// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "multicam_egomotion/tracking/departed_features.h"

#include <algorithm>
#include <cstddef>
#include <opencv2/core/types.hpp>
#include <utility>

namespace multicam_egomotion {
namespace {

constexpr std::size_t kLevels = 2;  // of the pyramid that are kept,
constexpr int kGrid = 1 << (kLevels - 1);
constexpr int kHalfSize = 24;  // around the feature at the finest [px]

}  // namespace

void DepartedFeatures::add(const FramePair& frames, const Feature& feature) {
  const FlowPyramid& pyramid = frames.previous[feature.owner];
  if (pyramid.empty()) return;
  Departed departed;
  departed.camera = feature.owner;
  departed.point = feature.points[feature.owner];
  departed.T_body_cam = frames.previous_T_body_cam[feature.owner];
  // The coarser levels begin at the same place.
  const auto first = [](double centre) { return std::max(0, static_cast<int>(centre) - kHalfSize) / kGrid * kGrid; };
  const cv::Point corner(first(departed.point.pixel.x()), first(departed.point.pixel.y()));
  departed.point.pixel -= Eigen::Vector2d(corner.x, corner.y);
  const auto& images = pyramid.images();
  for (std::size_t level = 0; level < std::min(kLevels, images.size()); ++level) {
    const int scale = 1 << level;
    const cv::Rect part(corner / scale, cv::Size(2 * kHalfSize / scale, 2 * kHalfSize / scale));
    departed.image.push_back(images[level](part & cv::Rect({0, 0}, images[level].size())).clone());
  }
  departed_[feature.id] = std::move(departed);
}

std::vector<Feature> DepartedFeatures::find(const std::vector<TrackedPoint>& points,
                                            const Eigen::Isometry3d& T_cur_prev, const FramePair& frames) {
  std::vector<Feature> found;
  std::map<TrackId, Departed> known;
  for (const TrackedPoint& point : points) {
    const auto it = departed_.find(point.track);
    if (it == departed_.end()) continue;
    Departed& departed = it->second;
    departed.T_body_cam = T_cur_prev * departed.T_body_cam;
    Feature feature;
    int camera = 0;
    while (camera < rig_.size() && !findIn(camera, departed, point, frames, &feature)) ++camera;
    if (camera < rig_.size()) {
      found.push_back(std::move(feature));
    } else {
      known.insert(departed_.extract(it));
    }
  }
  departed_ = std::move(known);
  return found;
}

bool DepartedFeatures::findIn(int camera, const Departed& departed, const TrackedPoint& point, const FramePair& frames,
                              Feature* feature) const {
  if (camera == departed.camera || frames.current[camera].empty()) return false;
  const Eigen::Isometry3d T_cam_body = frames.T_body_cam[camera].inverse();
  const Eigen::Vector3d position = T_cam_body * point.position;
  Eigen::Vector2d pixel;
  if (!rig_.camera(camera).model.project(position, &pixel) || !regions_.contain(camera, pixel)) return false;
  const CrossCameraMatcher::Pair pair{departed.camera,
                                      camera,
                                      departed.image,
                                      frames.current[camera].images(),
                                      T_cam_body * departed.T_body_cam,
                                      frames.slackBetween(departed.camera, camera)};
  const double distance = (point.position - departed.T_body_cam.translation()).norm();
  const auto match = matcher_.rematch(pair, departed.point, 1.0 / distance, WarpModel::kAffine);
  if (!match || !regions_.contain(camera, match->point.pixel)) return false;
  feature->id = point.track;
  feature->owner = camera;
  feature->inverse_distance = 1.0 / position.norm();
  feature->seen[camera] = true;
  feature->points[camera] = match->point;
  return true;
}

}  // namespace multicam_egomotion
