// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "multicam_egomotion/odometry/track_matches.h"

#include <cmath>

namespace multicam_egomotion {
namespace {

// Image scale at an observation [px/rad].
double pixelsPerRadian(const FeatureObservation& feature) { return feature.to_pixel.norm() / std::sqrt(2.0); }

std::vector<Eigen::Vector3d> centers(const std::vector<Eigen::Isometry3d>& T_body_cam) {
  std::vector<Eigen::Vector3d> result;
  for (const Eigen::Isometry3d& T : T_body_cam) result.push_back(T.translation());
  return result;
}

}  // namespace

TrackMatches matchTracks(const PosedFrame& previous, const PosedFrame& newest, const Eigen::Matrix3d& R_f2_f1,
                         double max_turn_sigma_px) {
  const auto loose = [&](int camera) {
    return !newest.turn_sigma_px.empty() && newest.turn_sigma_px[camera] > max_turn_sigma_px;
  };
  std::vector<CorrespondenceSet::Entry> entries;
  std::vector<TrackId> tracks;
  std::vector<double> parallaxes;
  const auto& first = previous.frame.observations;
  const auto& second = newest.frame.observations;
  std::size_t begin = 0;  // both are sorted by track
  for (const FeatureObservation& now : second) {
    while (begin < first.size() && first[begin].track < now.track) ++begin;
    for (std::size_t i = begin; i < first.size() && first[i].track == now.track; ++i) {
      const FeatureObservation& then = first[i];
      if (then.camera != now.camera && (loose(then.camera) || loose(now.camera))) continue;
      const Eigen::Isometry3d& T1 = previous.T_body_cam[then.camera];
      const Eigen::Isometry3d& T2 = newest.T_body_cam[now.camera];
      CorrespondenceSet::Entry entry;
      entry.rays.first = makeRay(T1.linear() * then.bearing, T1.translation());
      entry.rays.second = makeRay(T2.linear() * now.bearing, T2.translation());
      entry.rays.camera1 = then.camera;
      entry.rays.camera2 = now.camera;
      entry.pixels_per_radian1 = pixelsPerRadian(then);
      entry.pixels_per_radian2 = pixelsPerRadian(now);
      entries.push_back(entry);
      tracks.push_back(now.track);
      double parallax = -1.0;
      if (then.camera == now.camera) {
        const Eigen::Vector3d expected = T2.linear().transpose() * (R_f2_f1 * entry.rays.first.direction);
        const double depth = now.bearing.dot(expected);
        if (depth > 0.1) parallax = (now.to_pixel * expected).norm() / depth;
      }
      parallaxes.push_back(parallax);
    }
  }
  return {CorrespondenceSet(entries, centers(previous.T_body_cam), centers(newest.T_body_cam)), tracks, parallaxes};
}

}  // namespace multicam_egomotion
