// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

namespace multicam_egomotion {

/// Warp of a patch: patch coordinates (x, y) (pixels about its centre) lie at
/// pixel + linear * (x, y) + curvature * (x^2, x y, y^2) in the image.
struct PatchWarp {
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
  Eigen::Matrix2d linear = Eigen::Matrix2d::Identity();
  Eigen::Matrix<double, 2, 3> curvature = Eigen::Matrix<double, 2, 3>::Zero();  ///< [1/px]
};

/// Which part of the warp align() estimates.
enum class WarpModel { kTranslation, kAffine };

struct PatchAlignmentOptions {
  int max_iterations = 10;
  double epsilon_px = 0.003;     ///< stops when an iteration moves the patch less
  double max_shift_px = 3.0;     ///< from the initial guess; further away is a failure
  double min_correlation = 0.8;  ///< zero-mean normalized cross-correlation at the result
};

/// Square grey patch prepared for sub-pixel alignment by inverse-compositional Gauss-Newton (Baker and Matthews,
/// "Lucas-Kanade 20 years on", IJCV 2004, section 3.2), invariant to gain and offset of the brightness: the Jacobian is
/// made orthogonal to the patch and to a constant, so that neither needs to be estimated.
class PatchTemplate {
 public:
  static constexpr int kMaxSize = 21;

  /// Cuts a size x size patch (odd, 5 to kMaxSize) out of a CV_8UC1 image, sampled through `warp`.
  /// False when it leaves the image or has no texture in two directions; the template must not be used then.
  bool cut(const cv::Mat& image, const PatchWarp& warp, int size, WarpModel model);

  /// Moves `warp` (initial guess in, result out) to where the patch is found in `image`, CV_8UC1. False, and `warp`
  /// unchanged, when it leaves the image, does not converge, or is not alike. `correlation` (optional): at the result.
  bool align(const cv::Mat& image, const PatchAlignmentOptions& options, PatchWarp* warp,
             double* correlation = nullptr) const;

  /// Zero-mean normalized cross-correlation at `warp`, -1 outside the image.
  double correlation(const cv::Mat& image, const PatchWarp& warp) const;

 private:
  static constexpr int kMaxPixels = kMaxSize * kMaxSize;
  static constexpr int kMaxParameters = 6;
  using Columns = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMaxPixels, kMaxParameters + 1>;

  int size_ = 0;
  int parameters_ = 0;  ///< 2 or 6
  /// One row a pixel: derivatives by shift x, y, then by the linear part 00, 01, 10, 11 (affine only), and last the
  /// intensity; all columns of zero mean, the derivatives orthogonal to the intensity.
  Columns columns_;
  double energy_ = 0.0;  ///< squared norm of the intensity
  Eigen::Matrix<double, kMaxParameters, kMaxParameters> inverse_hessian_;
};

}  // namespace multicam_egomotion
