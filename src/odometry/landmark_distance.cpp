// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "multicam_egomotion/odometry/landmark_distance.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace multicam_egomotion {
namespace {

constexpr double kUsualInverseDistance = 0.3;  // of points whose distance is not seen [1/m]

}  // namespace

double findInverseDistance(const BundleLandmark& landmark, const BundleAdjustment& bundle) {
  double best_cost = std::numeric_limits<double>::infinity(), best = 0.0;
  BundleLandmark tried = landmark;
  for (int k = 0; k <= 24; ++k) {
    const double inverse_distance = k == 0 ? 0.0 : 0.002 * std::pow(1.35, k - 1);  // 0, then 1/500 m to about 1/0.5 m
    double cost = std::pow(inverse_distance / kUsualInverseDistance, 2);
    tried.inverse_distance = inverse_distance;
    for (const BundleObservation& observation : landmark.observations) {
      const double error = bundle.normalizedError(tried, observation);
      cost += error < 0.0 ? 1e6 : std::min(error * error, 1e6);
    }
    if (cost < best_cost) {
      best_cost = cost;
      best = inverse_distance;
    }
  }
  return best;
}

}  // namespace multicam_egomotion
