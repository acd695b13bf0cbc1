// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "simulator/track_simulator.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "simulator/random.h"
#include "simulator/simulator.h"

namespace multicam_egomotion {

namespace {

constexpr std::uint64_t kTrackStream = 2;

/// Grows tracks frame by frame.
class TrackSource {
 public:
  TrackSource(const Simulator& simulator, const TrackSimulationOptions& options)
      : simulator_(simulator), options_(options), random_(options.seed, kTrackStream) {}

  void addFrame(int frame, SimulatedTracks* tracks) {
    T_world_body_ = simulator_.stateAtFrame(frame).T_world_body;
    const CameraRig& rig = simulator_.scenario().rig;

    // Live tracks first: camera mask by track, in the order of ids.
    std::vector<int> seen(rig.size(), 0);
    for (auto it = live_.begin(); it != live_.end();) {
      it->second.visible = visibleCameras(it->second);
      const bool lost = it->second.visible == 0 || random_.uniform() < options_.loss_share;
      if (!lost) count(it->second.visible, &seen);
      it = lost ? live_.erase(it) : std::next(it);
    }
    for (int camera = 0; camera < rig.size(); ++camera) {
      // Bounded, since a camera may look at the sky alone.
      for (int attempt = 0; attempt < 4 * options_.tracks_per_camera; ++attempt) {
        if (seen[camera] >= options_.tracks_per_camera) break;
        Track track;
        if (!findPoint(camera, &track)) continue;
        count(track.visible, &seen);
        tracks->points[next_id_] = track.point;
        live_[next_id_++] = track;
      }
    }

    TrackedFrame tracked;
    tracked.stamp_ns = simulator_.frameStamp(frame);
    std::vector<bool> outlier;
    for (const auto& [id, track] : live_) {
      for (int camera = 0; camera < rig.size(); ++camera) {
        if (track.visible >> camera & 1) observe(id, track, camera, &tracked, &outlier);
      }
    }
    tracks->frames.push_back(tracked);
    tracks->outlier.push_back(outlier);
  }

 private:
  struct Track {
    Eigen::Vector3d point;  // world
    int camera = 0;         // where it was born
    unsigned visible = 0;   // bit mask of cameras
  };

  static void count(unsigned visible, std::vector<int>* seen) {
    for (std::size_t i = 0; i < seen->size(); ++i) (*seen)[i] += visible >> i & 1;
  }

  bool findPoint(int camera, Track* track) {
    const RigCamera& one = simulator_.scenario().rig.camera(camera);
    const Eigen::Vector2d pixel(random_.uniform(0, one.model.width() - 1), random_.uniform(0, one.model.height() - 1));
    Eigen::Vector3d bearing;
    if (!one.model.unproject(pixel, &bearing)) return false;
    const double distance = simulator_.distance(camera, T_world_body_, pixel);
    if (!std::isfinite(distance)) return false;
    track->point = T_world_body_ * one.T_body_cam * (distance * bearing);
    track->camera = camera;
    track->visible = visibleCameras(*track);
    return track->visible >> camera & 1;
  }

  unsigned visibleCameras(const Track& track) const {
    const CameraRig& rig = simulator_.scenario().rig;
    unsigned visible = 0;
    for (int camera = 0; camera < rig.size(); ++camera) {
      if (!options_.cross_camera && camera != track.camera) continue;
      const RigCamera& one = rig.camera(camera);
      const Eigen::Isometry3d T_world_cam = T_world_body_ * one.T_body_cam;
      const Eigen::Vector3d offset = track.point - T_world_cam.translation();
      const double range = offset.norm();
      Eigen::Vector2d pixel;
      if (range < options_.min_range || range > options_.max_range ||
          !one.model.project(T_world_cam.linear().transpose() * offset, &pixel) ||
          !one.model.contains(pixel, options_.border_px)) {
        continue;
      }
      const SceneHit hit = simulator_.scenario().scene->castRay(T_world_cam.translation(), offset / range);
      if (hit.distance > range - 1e-6 * (1.0 + range)) visible |= 1u << camera;
    }
    return visible;
  }

  void observe(TrackId id, const Track& track, int camera, TrackedFrame* tracked, std::vector<bool>* outlier) {
    const RigCamera& one = simulator_.scenario().rig.camera(camera);
    Eigen::Vector2d pixel;
    if (!one.model.project((T_world_body_ * one.T_body_cam).inverse() * track.point, &pixel)) return;
    pixel.x() += options_.pixel_sigma * random_.gaussian();
    pixel.y() += options_.pixel_sigma * random_.gaussian();
    const bool wrong = random_.uniform() < options_.outlier_share;
    if (wrong) {
      const double angle = random_.uniform(0.0, 2.0 * M_PI), size = random_.uniform(5.0, 40.0);
      pixel += size * Eigen::Vector2d(std::cos(angle), std::sin(angle));
    }
    FeatureObservation observation;
    observation.track = id;
    observation.camera = camera;
    observation.pixel = pixel;
    Eigen::Vector2d back;
    if (!one.model.contains(pixel) || !one.model.unproject(pixel, &observation.bearing) ||
        !one.model.project(observation.bearing, &back, &observation.to_pixel)) {
      return;
    }
    tracked->observations.push_back(observation);
    outlier->push_back(wrong);
  }

  const Simulator& simulator_;
  const TrackSimulationOptions& options_;
  Random random_;
  Eigen::Isometry3d T_world_body_;
  std::map<TrackId, Track> live_;
  TrackId next_id_ = 1;
};

}  // namespace

SimulatedTracks simulateTracks(const Scenario& scenario, const TrackSimulationOptions& options) {
  const Simulator simulator(scenario);
  TrackSource source(simulator, options);
  SimulatedTracks tracks;
  for (int frame = 0; frame < simulator.frames(); ++frame) source.addFrame(frame, &tracks);
  return tracks;
}

}  // namespace multicam_egomotion
