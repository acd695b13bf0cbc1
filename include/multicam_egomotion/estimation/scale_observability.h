// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

namespace multicam_egomotion {

enum class ScaleState {
  kNotApplicable,  ///< no motion to be told from noise
  kObservable,     ///< scale_sigma < 0.1
  kWeak,           ///< scale_sigma < 0.5
  kUnobservable,
};

struct ScaleObservability {
  double sigma;  ///< standard deviation of the length of t, as a share of it
  ScaleState state;
};

/// What a translation [m] and its covariance [m^2] (from images and rotation priors alone) say of the metric scale:
/// sigma = sqrt(t^T covariance t) / |t|^2. Where the length is much less known than the rest, the noise across it tells
/// whether there is motion at all, else the largest.
ScaleObservability scaleObservability(const Eigen::Vector3d& t, const Eigen::Matrix3d& covariance);

}  // namespace multicam_egomotion
