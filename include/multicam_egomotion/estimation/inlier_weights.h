// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "multicam_egomotion/estimation/correspondence_set.h"

namespace multicam_egomotion {

/// Weights of the correspondences in a refinement, by index, from their residuals beside a pose that is nearly right.
///
/// The product of two. First the probability that it is no outlier that lies on its epipolar line by chance, 0 where
/// that is below 0.1. Likelihoods are compared at each distance of the points (windows of one and a half octaves):
/// inliers have normal errors of `sigma` [px] and the distances of the other inliers; the density of outliers is seen
/// in the errors between 2 and 22 times `limit` [px]. No error of `limit` or more is an inlier.
///
/// Then 1 / (1 + q / s) by its leverage q, with s such that this is 3/4 in the mean: outliers by chance mostly have a
/// larger parallax than any inlier, the more so where the baseline of their camera pair is short, and with it so much
/// influence on the translation that they would bend the pose until they fit.
void weighInliers(const CorrespondenceSet::Residuals& residuals, double sigma, double limit,
                  std::vector<double>* weights);

}  // namespace multicam_egomotion
