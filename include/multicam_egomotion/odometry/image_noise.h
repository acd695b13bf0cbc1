// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "multicam_egomotion/estimation/bundle_adjustment.h"

namespace multicam_egomotion {

/// Noise of the tracked points, measured by what a bundle adjustment leaves.
class ImageNoise {
 public:
  /// All three in pixels: until it has been measured, and its bounds.
  ImageNoise(double initial_sigma, double min_sigma, double max_sigma)
      : sigma_(initial_sigma), min_sigma_(min_sigma), max_sigma_(max_sigma) {}

  /// From an adjustment made with pixelSigma() whose last two poses are the previous and the newest frame.
  void measure(const BundleAdjustment& bundle, const BundleSummary& summary, double robust_width);

  double pixelSigma() const { return sigma_; }

  /// Of what all views of a track in one camera have in common against those in another, per axis [px].
  double offsetSigma() const { return offset_sigma_; }

  /// Share of pixelSigma()'s variance that counts in the motion between two frames: much of a tracked patch's error is
  /// the same in both and cancels, and pixelSigma() has a floor for what calibration leaves.
  double whiteShare() const { return white_share_; }

 private:
  void measureOffsets(const BundleAdjustment& bundle, double robust_width, double gain);

  double sigma_, min_sigma_, max_sigma_;
  double offset_sigma_ = 0.25;
  double white_share_ = 1.0;
  int measurements_ = 0;
};

}  // namespace multicam_egomotion
