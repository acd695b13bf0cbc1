// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

namespace multicam_egomotion {

enum class Distortion {
  kNone,                ///< ideal or rectified pinhole
  kRadtan,              ///< OpenCV / ROS plumb_bob: k1 k2 p1 p2 [k3]
  kRationalPolynomial,  ///< OpenCV / ROS rational_polynomial: k1 k2 p1 p2 k3 k4 k5 k6
  kEquidistant,         ///< OpenCV fisheye, Kalibr equidistant (Kannala-Brandt): k1 k2 k3 k4
};

/// Intrinsics of one camera: pixel <-> unit bearing in the optical frame (x right, y down, z forward).
/// Immutable value. Pixel coordinates have (0, 0) at the centre of the upper left pixel, as OpenCV and ROS.
class CameraModel {
 public:
  /// fx, fy, cx, cy [px]; coefficients in the order above, missing trailing ones are 0.
  /// Throws std::invalid_argument (name, found, expected) on a size, focal length or coefficient that cannot be.
  CameraModel(int width, int height, double fx, double fy, double cx, double cy, Distortion distortion,
              const std::vector<double>& coefficients);

  /// Unit bearing of a pixel; false where the model cannot be inverted (beyond the valid field of view) or not finite.
  /// `d_bearing_d_pixel` (3x2, optional) [1/px].
  bool unproject(const Eigen::Vector2d& pixel, Eigen::Vector3d* bearing,
                 Eigen::Matrix<double, 3, 2>* d_bearing_d_pixel = nullptr) const;

  /// Pixel of a point or bearing in the optical frame (any norm > 0); false outside the valid field of view
  /// (behind a pinhole, beyond the distortion's monotonic range). Does not test the image border: see contains().
  /// `d_pixel_d_point` (2x3, optional).
  bool project(const Eigen::Vector3d& point, Eigen::Vector2d* pixel,
               Eigen::Matrix<double, 2, 3>* d_pixel_d_point = nullptr) const;

  bool contains(const Eigen::Vector2d& pixel, double border_px = 0.0) const;

  int width() const { return width_; }
  int height() const { return height_; }
  double focalLength() const;  ///< sqrt(fx fy) [px]
  double fx() const { return fx_; }
  double fy() const { return fy_; }
  double cx() const { return cx_; }
  double cy() const { return cy_; }
  Distortion distortion() const { return distortion_; }
  const std::vector<double>& coefficients() const { return coefficients_; }

 private:
  int width_, height_;
  double fx_, fy_, cx_, cy_;
  Distortion distortion_;
  std::vector<double> coefficients_;
  std::array<double, 8> k_{};  ///< coefficients_ padded with zeros, in the same order
  double
      max_radius_;  ///< largest undistorted radius (or angle [rad] for the fisheye) where the distortion is monotonic
};

/// "none", "radtan"/"plumb_bob", "rational_polynomial", "equidistant"/"fisheye"; throws std::invalid_argument.
Distortion distortionFromName(const std::string& name);

}  // namespace multicam_egomotion
