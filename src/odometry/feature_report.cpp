// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "multicam_egomotion/odometry/feature_report.h"

#include <algorithm>

namespace multicam_egomotion {

std::vector<FeatureReport> reportFeatures(const TrackedFrame& previous, const TrackedFrame& newest,
                                          const std::unordered_set<TrackId>& inlier_tracks) {
  std::vector<FeatureReport> reports;
  const auto& before = previous.observations;
  for (const FeatureObservation& feature : newest.observations) {
    FeatureReport report;
    report.track = feature.track;
    report.camera = feature.camera;
    report.pixel = report.previous_pixel = feature.pixel;
    const auto earlier = std::lower_bound(before.begin(), before.end(), feature, [](const auto& a, const auto& b) {
      return a.track != b.track ? a.track < b.track : a.camera < b.camera;
    });
    if (earlier != before.end() && earlier->track == feature.track && earlier->camera == feature.camera) {
      report.previous_pixel = earlier->pixel;
      report.is_new = false;
    }
    report.inlier = inlier_tracks.count(feature.track) > 0;
    reports.push_back(report);
  }
  return reports;
}

}  // namespace multicam_egomotion
