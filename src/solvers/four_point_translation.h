// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

namespace multicam_egomotion {

/// Sine of the rotation, or relative singular value, below which scale is not observable.
constexpr double kScaleTolerance = 1e-7;
/// Angle between the two rays of a correspondence below which it says nothing about the translation [rad].
constexpr double kNoParallax = 1e-7;

/// Four correspondences in frames that differ by a rotation about z.
struct AlignedRays {
  Eigen::Matrix<double, 3, 4> x1, x2;  // directions
  Eigen::Matrix<double, 3, 4> p1, p2;  // points of the rays
};

/// Translation where the depths of the origin do not give it: least squares on m · (t - (p2 - R p1)) = 0,
/// m = R x1 × x2, of all four correspondences. Scale is not observable where constants and normals together have
/// rank 2. Returns false where not even the direction is determined.
bool translationFromAllRows(const AlignedRays& rays, double c, double s, double* t, bool& scale_observable);

}  // namespace multicam_egomotion
