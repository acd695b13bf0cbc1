// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "multicam_egomotion/odometry/image_noise.h"

#include <algorithm>
#include <cmath>

namespace multicam_egomotion {
namespace {

constexpr double kGain = 0.1;  // share of a frame's measured noise in the running estimate
// Share of a patch's own error that stays from frame to frame where nothing moves, and the parallax that changes it
// [px].
constexpr double kKeptPatchError = 0.8;
constexpr double kPatchChangePx = 10.0;
constexpr double kSmallestOffset = 0.02;  // keeps their prior invertible where images are exact [px]

}  // namespace

// Across the direction in which the point's distance would take up an offset. What an offset has been shrunk by, with
// the prior that is measured here, is undone, so that a rise is seen at once.
void ImageNoise::measureOffsets(const BundleAdjustment& bundle, double robust_width, double gain) {
  const double prior = bundle.offset_sigma * bundle.offset_sigma, noise = bundle.pixel_sigma * bundle.pixel_sigma;
  double weights = 0.0, squares = 0.0;
  for (const BundleLandmark& landmark : bundle.landmarks) {
    for (int camera = 0; camera < CameraRig::kMaxCameras; ++camera) {
      if (camera == landmark.observations.front().camera) continue;
      const BundleObservation* newest = nullptr;
      double views = 0.0;
      for (const BundleObservation& view : landmark.observations) {
        if (view.camera != camera) continue;
        newest = &view;
        views += 1.0;
      }
      Eigen::Vector2d error_px, along;
      if (!newest || !bundle.error(landmark, *newest, &error_px, &along) || along.norm() < 1e-9) continue;
      const Eigen::Vector2d across = Eigen::Vector2d(-along.y(), along.x()).normalized();
      const double kept = prior / (prior + noise / views);
      const double square = std::pow(across.dot(landmark.offsets[camera]) / kept, 2);
      const double weight = 1.0 / (1.0 + square / (robust_width * robust_width * (prior + noise / views)));
      weights += weight;
      squares += weight * (square - noise / views);
    }
  }
  if (weights < 10.0) return;
  const double measured = std::max(squares / weights, 0.0);
  offset_sigma_ = std::clamp(std::sqrt((1.0 - gain) * offset_sigma_ * offset_sigma_ + gain * measured), kSmallestOffset,
                             max_sigma_);
}

void ImageNoise::measure(const BundleAdjustment& bundle, const BundleSummary& summary, double robust_width) {
  if (summary.degrees_of_freedom < 20.0) return;
  const double gain = std::max(kGain, 1.0 / ++measurements_);
  const double ratio = std::min(summary.weighted_square_sum / summary.degrees_of_freedom, 9.0);
  const double measured_sigma = sigma_ * std::sqrt(ratio);
  sigma_ = std::clamp(std::sqrt((1.0 - gain) * sigma_ * sigma_ + gain * measured_sigma * measured_sigma), min_sigma_,
                      max_sigma_);
  measureOffsets(bundle, robust_width, gain);

  const int newest = static_cast<int>(bundle.poses.size()) - 1;
  const double w2 = std::pow(robust_width * measured_sigma, 2);
  double weights = 0.0, squares = 0.0, kept = 0.0;
  for (const BundleLandmark& landmark : bundle.landmarks) {
    for (const BundleObservation& now : landmark.observations) {
      if (now.pose != newest) continue;
      for (const BundleObservation& before : landmark.observations) {
        Eigen::Vector2d error_now, error_before, depth_now, depth_before;
        if (before.pose != newest - 1 || before.camera != now.camera ||
            !bundle.error(landmark, now, &error_now, &depth_now) ||
            !bundle.error(landmark, before, &error_before, &depth_before)) {
          continue;
        }
        // Across the direction in which the point's distance, itself estimated, would take up the change.
        const Eigen::Vector2d along = depth_now - depth_before;
        const Eigen::Vector2d across = Eigen::Vector2d(-along.y(), along.x()).normalized();
        const double square = 0.5 * std::pow(across.dot(error_now - error_before), 2);
        const double weight = 1.0 / (1.0 + square / w2);
        weights += weight;
        squares += weight * square;
        kept += weight * std::exp(-std::pow(along.norm() * landmark.inverse_distance / kPatchChangePx, 2));
      }
    }
  }
  if (weights < 10.0) return;
  // Part of what stays with the patches still shows: their shapes change, the more the more the view does.
  const double white = squares / weights;
  const double total = std::max(measured_sigma * measured_sigma, white);
  const double patch_share = 1.0 - kKeptPatchError * kept / weights;
  white_share_ = std::clamp((white + patch_share * (total - white)) / (sigma_ * sigma_), 1e-4, 1.0);
}

}  // namespace multicam_egomotion
