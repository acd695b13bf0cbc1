// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>

#include "multicam_egomotion/geometry/camera_model.h"

namespace multicam_egomotion {

/// A pixel with its bearing and the derivative that carries pixel errors to the sphere.
struct ImagePoint {
  Eigen::Vector2d pixel;
  Eigen::Vector3d bearing;                         ///< unit, optical frame
  Eigen::Matrix<double, 3, 2> bearing_derivative;  ///< d bearing / d pixel [1/px]
};

/// False where the model cannot be inverted.
bool makeImagePoint(const CameraModel& model, const Eigen::Vector2d& pixel, ImagePoint* point);

/// Pseudo-inverse of the bearing derivative: bearing differences to pixels, 2x3 [px].
Eigen::Matrix<double, 2, 3> bearingToPixel(const ImagePoint& point);

/// Signed Sampson error [px] of the epipolar constraint b · (t × R a) = 0, first order in the pixels of both images.
/// T_b_a maps the optical frame of a into that of b. Zero when the two centres coincide.
double epipolarError(const ImagePoint& a, const ImagePoint& b, const Eigen::Isometry3d& T_b_a);

/// Inverse distance [1/m] from the centre of a along its bearing to the point where it comes closest to the ray of b
/// (least squares of b × (R a + rho t)); negative for rays that diverge, 0 when the centres coincide.
double inverseDistance(const ImagePoint& a, const ImagePoint& b, const Eigen::Isometry3d& T_b_a);

}  // namespace multicam_egomotion
