// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "multicam_egomotion/tracking/temporal_tracker.h"

#include <algorithm>
#include <limits>
#include <memory>

namespace multicam_egomotion {
namespace {

// A reference patch that fails in this many frames in a row is replaced by the newest one.
constexpr int kMaxReferenceFailures = 3;
// Where the last predictions were this good, few pyramid levels come first, and all only for what these lose.
constexpr double kGoodPredictionPx = 4.0;
constexpr int kFewLevels = 2;
constexpr std::size_t kMinPredictionErrors = 10;
constexpr double kCurvatureStep = 0.35;  // of the size of a patch

}  // namespace

TemporalTracker::TemporalTracker(const CameraRig& rig, const FeatureRegions& regions,
                                 const FeatureTrackerOptions& options)
    : rig_(rig),
      regions_(regions),
      options_(options),
      flow_(opticalFlowOptions(options)),
      max_prediction_error_(rig.size(), std::numeric_limits<double>::infinity()),
      prediction_errors_(rig.size()) {
  for (const RigCamera& camera : rig.cameras()) {
    curvatures_.emplace_back(camera.model, kCurvatureStep * options.patch_size_px);
  }
}

int TemporalTracker::track(const FramePair& frames, int camera, std::vector<Feature*> features,
                           FeatureTrackerCounters* counters) {
  if (features.empty() || frames.previous[camera].empty() || frames.current[camera].empty()) return 0;
  const bool few_levels = max_prediction_error_[camera] < kGoodPredictionPx;
  const int levels = few_levels ? std::min(kFewLevels, flow_.pyramid_levels) : flow_.pyramid_levels;
  int tracked = trackLevels(frames, camera, levels, features, counters);
  if (few_levels) {
    features.erase(std::remove_if(features.begin(), features.end(), [](const Feature* f) { return f->alive; }),
                   features.end());
    tracked += trackLevels(frames, camera, flow_.pyramid_levels, features, counters);
  }
  counters->tracked += tracked;
  return tracked;
}

int TemporalTracker::trackLevels(const FramePair& frames, int camera, int levels, const std::vector<Feature*>& features,
                                 FeatureTrackerCounters* counters) {
  const FlowPyramid &previous = frames.previous[camera], &current = frames.current[camera];
  std::vector<cv::Point2f> origins, guesses;
  std::vector<unsigned char> found;
  const Eigen::Isometry3d T_cur_prev = frames.motion(camera);
  for (const Feature* feature : features) {
    const Eigen::Vector2d& pixel = feature->points[camera].pixel;
    const Eigen::Vector2d guess = predict(camera, T_cur_prev, *feature);
    origins.emplace_back(pixel.x(), pixel.y());
    guesses.emplace_back(guess.x(), guess.y());
  }
  std::vector<cv::Point2f> flowed = guesses;
  flowForward(previous, current, flow_, levels, origins, &flowed, &found);

  // Alignment to the reference vouches for a track; only without it the way back is worth its time.
  std::vector<Feature*> unaligned;
  std::vector<cv::Point2f> unaligned_origins, unaligned_points;
  int tracked = 0;
  for (std::size_t i = 0; i < features.size(); ++i) {
    if (!found[i]) continue;
    Feature& feature = *features[i];
    Eigen::Vector2d pixel(flowed[i].x, flowed[i].y);
    if (feature.owner != camera) cutReference(camera, previous, feature.points[camera].pixel, &feature);
    if (!alignToReference(camera, current, &feature, &pixel)) {
      unaligned.push_back(&feature);
      unaligned_origins.push_back(origins[i]);
      unaligned_points.push_back(flowed[i]);
      continue;
    }
    ++counters->reference_aligned;
    if (advance(camera, pixel, T_cur_prev, &feature)) {
      prediction_errors_[camera].push_back(static_cast<float>(cv::norm(flowed[i] - guesses[i])));
      ++tracked;
    }
  }
  flowReturns(previous, current, flow_, unaligned_origins, unaligned_points, &found);
  for (std::size_t i = 0; i < unaligned.size(); ++i) {
    Feature& feature = *unaligned[i];
    if (!found[i]) {
      ++counters->rejected_forward_backward;
    } else if (advance(camera, {unaligned_points[i].x, unaligned_points[i].y}, T_cur_prev, &feature)) {
      if (!feature.reference || ++feature.reference->failures >= kMaxReferenceFailures) {
        cutReference(camera, current, feature.points[camera].pixel, &feature);
      }
      ++tracked;
    }
  }
  return tracked;
}

// Where a feature of the previous frame should be now; at infinity where its distance is unknown.
Eigen::Vector2d TemporalTracker::predict(int camera, const Eigen::Isometry3d& T_cur_prev,
                                         const Feature& feature) const {
  const CameraModel& model = rig_.camera(camera).model;
  const ImagePoint& point = feature.points[camera];
  const double rho = feature.owner == camera ? std::max(0.0, feature.inverse_distance) : 0.0;
  Eigen::Vector2d pixel;
  const bool visible = model.project(T_cur_prev.linear() * point.bearing + rho * T_cur_prev.translation(), &pixel) &&
                       model.contains(pixel);
  return visible ? pixel : point.pixel;
}

// Moves a feature to `pixel` of the newest image of a camera, which then owns it.
bool TemporalTracker::advance(int camera, const Eigen::Vector2d& pixel, const Eigen::Isometry3d& T_cur_prev,
                              Feature* feature) const {
  ImagePoint point;
  if (!regions_.contain(camera, pixel) || !makeImagePoint(rig_.camera(camera).model, pixel, &point)) return false;
  if (feature->owner != camera) {
    feature->inverse_distance = -1.0;
  } else if (feature->inverse_distance > 0) {
    const Eigen::Vector3d p =
        T_cur_prev.linear() * feature->points[camera].bearing / feature->inverse_distance + T_cur_prev.translation();
    feature->inverse_distance = 1.0 / std::max(options_.min_distance_m, p.norm());
  }
  feature->owner = camera;
  feature->points[camera] = point;
  feature->seen[camera] = true;
  feature->alive = true;
  return true;
}

void TemporalTracker::endFrame() {
  for (int camera = 0; camera < rig_.size(); ++camera) {
    std::vector<float>& errors = prediction_errors_[camera];
    max_prediction_error_[camera] = std::numeric_limits<double>::infinity();
    if (errors.size() >= kMinPredictionErrors) {
      const auto rank = errors.begin() + errors.size() * 9 / 10;
      std::nth_element(errors.begin(), rank, errors.end());
      max_prediction_error_[camera] = *rank;
    }
    errors.clear();
  }
}

bool TemporalTracker::alignToReference(int camera, const FlowPyramid& pyramid, Feature* feature,
                                       Eigen::Vector2d* pixel) const {
  if (!feature->reference) return false;
  ReferencePatch& reference = *feature->reference;
  PatchAlignmentOptions alignment;
  alignment.max_shift_px = options_.max_reference_correction_px;
  const Eigen::Matrix<double, 2, 3> curvature =
      patchCurvature(reference.curvature, curvatures_[camera].at(*pixel), reference.linear);
  PatchWarp warp{*pixel, reference.linear, curvature};
  if (!reference.patch.align(pyramid.images()[0], alignment, &warp)) return false;
  reference.linear = warp.linear;
  reference.failures = 0;
  *pixel = warp.pixel;
  return true;
}

void TemporalTracker::cutReference(int camera, const FlowPyramid& pyramid, const Eigen::Vector2d& pixel,
                                   Feature* feature) const {
  if (!feature->reference) feature->reference = std::make_unique<ReferencePatch>();
  feature->reference->curvature = curvatures_[camera].at(pixel);
  feature->reference->linear.setIdentity();
  feature->reference->failures = 0;
  if (!feature->reference->patch.cut(pyramid.images()[0], {pixel, Eigen::Matrix2d::Identity()}, options_.patch_size_px,
                                     WarpModel::kAffine)) {
    feature->reference.reset();
  }
}

}  // namespace multicam_egomotion
