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

/// Translation of up to four rows (unit normal, constant), the others zero: least squares on normal · t = -constant.
/// Scale is not observable where constants and normals together have rank 2; t is a unit vector then, or zero without
/// any row. Returns false where not even the direction is determined.
bool leastSquaresTranslation(const Eigen::Matrix4d& rows, Eigen::Vector3d& t, bool& scale_observable);

/// Translation where the depths of the origin do not give it: leastSquaresTranslation of m · (t - (p2 - R p1)) = 0,
/// m = R x1 × x2, of all four correspondences.
bool translationFromAllRows(const AlignedRays& rays, double c, double s, double* t, bool& scale_observable);

/// One Newton step of t [m] and the angle on the four constraints themselves, for a pose that meets them but for
/// rounding. Returns the step of the angle [rad].
double correctPose(const AlignedRays& rays, double c, double s, double* t);

}  // namespace multicam_egomotion
