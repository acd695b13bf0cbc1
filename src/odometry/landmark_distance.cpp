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

double findInverseDistance(const BundleLandmark& landmark, const std::vector<BundlePose>& poses, double pixel_sigma) {
  double best_cost = std::numeric_limits<double>::infinity(), best = 0.0;
  for (int k = 0; k <= 24; ++k) {
    const double inverse_distance = k == 0 ? 0.0 : 0.002 * std::pow(1.35, k - 1);  // 0, then 1/500 m to about 1/0.5 m
    double cost = std::pow(inverse_distance / kUsualInverseDistance, 2);
    for (const BundleObservation& observation : landmark.observations) {
      const BundlePose& pose = poses[observation.pose];
      const Eigen::Vector3d x =
          pose.R.transpose() * (landmark.direction + inverse_distance * (landmark.origin - pose.p)) -
          inverse_distance * observation.center;
      const double depth = observation.bearing.dot(x);
      const double error = depth > 1e-6 ? (observation.to_pixel * x).norm() / (depth * pixel_sigma) : 1e3;
      cost += std::min(error * error, 1e6);
    }
    if (cost < best_cost) {
      best_cost = cost;
      best = inverse_distance;
    }
  }
  return best;
}

}  // namespace multicam_egomotion
