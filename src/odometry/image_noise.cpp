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

}  // namespace

void ImageNoise::measure(const BundleAdjustment& bundle, const BundleSummary& summary, double robust_width) {
  if (summary.degrees_of_freedom < 20.0) return;
  const double gain = std::max(kGain, 1.0 / ++measurements_);
  const double ratio = std::min(summary.weighted_square_sum / summary.degrees_of_freedom, 9.0);
  const double measured_sigma = sigma_ * std::sqrt(ratio);
  sigma_ = std::clamp(std::sqrt((1.0 - gain) * sigma_ * sigma_ + gain * measured_sigma * measured_sigma), min_sigma_,
                      max_sigma_);

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
