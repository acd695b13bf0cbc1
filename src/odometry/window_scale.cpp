// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "multicam_egomotion/odometry/window_scale.h"

#include <algorithm>
#include <utility>

namespace multicam_egomotion {
namespace {

constexpr int kManyOverlaps = 20;  // landmarks seen by two cameras at once, whose distance tells the scale
constexpr int kMaxHops = 6;
constexpr double kBetter = 1.0;  // cost by which another scale has to be better

BundleAdjustment scaledAboutFirstPose(const BundleAdjustment& bundle, double factor) {
  BundleAdjustment scaled = bundle;
  const Eigen::Vector3d& first = bundle.poses.front().p;
  for (BundlePose& pose : scaled.poses) pose.p = first + factor * (pose.p - first);
  for (BundleLandmark& landmark : scaled.landmarks) {
    const int pose = landmark.observations.front().pose;
    landmark.origin += scaled.poses[pose].p - bundle.poses[pose].p;
    landmark.inverse_distance /= factor;
  }
  return scaled;
}

}  // namespace

bool overlapShowsScale(const BundleAdjustment& bundle) {
  const auto seenByTwo = [](const BundleLandmark& landmark) {
    const auto& views = landmark.observations;
    return std::adjacent_find(views.begin(), views.end(), [](const auto& a, const auto& b) {
             return a.pose == b.pose && a.camera != b.camera;
           }) != views.end();
  };
  return std::count_if(bundle.landmarks.begin(), bundle.landmarks.end(), seenByTwo) >= kManyOverlaps;
}

void findScale(const BundleOptions& options, BundleAdjustment* bundle, BundleSummary* summary) {
  if (overlapShowsScale(*bundle)) return;
  for (const double factor : {2.0, 0.5}) {
    for (int hop = 0; hop < kMaxHops; ++hop) {
      BundleAdjustment other = scaledAboutFirstPose(*bundle, factor);
      const BundleSummary other_summary = other.solve(options);
      if (!other_summary.finite || !(other_summary.cost < summary->cost - kBetter)) break;
      *bundle = std::move(other);
      *summary = other_summary;
    }
  }
}

}  // namespace multicam_egomotion
