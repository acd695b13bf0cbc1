// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "multicam_egomotion/estimation/scale_observability.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

namespace multicam_egomotion {
namespace {
constexpr double kObservable = 0.1, kWeak = 0.5;
constexpr double kEvenlySeen = 5.0;    // ratio of the noise along and across up to which all directions count as seen
constexpr double kMotionSigmas = 3.0;  // less than this is no motion
}  // namespace

ScaleObservability scaleObservability(const Eigen::Vector3d& t, const Eigen::Matrix3d& covariance) {
  const double distance = t.norm();
  if (!(distance > 0.0)) return {std::numeric_limits<double>::infinity(), ScaleState::kNotApplicable};
  const double sigma = std::sqrt(std::max(0.0, t.dot(covariance * t))) / (distance * distance);
  const Eigen::Vector3d spread = covariance.selfadjointView<Eigen::Lower>().eigenvalues();
  const double least = std::sqrt(std::max(0.0, 0.5 * (spread[0] + spread[1])));
  const double most = std::sqrt(std::max(0.0, spread[2]));
  const double noise = most < kEvenlySeen * least ? most : least;
  const ScaleState state = distance < kMotionSigmas * noise ? ScaleState::kNotApplicable
                           : sigma < kObservable            ? ScaleState::kObservable
                           : sigma < kWeak                  ? ScaleState::kWeak
                                                            : ScaleState::kUnobservable;
  return {sigma, state};
}

}  // namespace multicam_egomotion
