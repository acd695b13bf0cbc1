// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "multicam_egomotion/estimation/bundle_adjustment.h"

namespace multicam_egomotion {

/// Inverse distance [1/m] of a landmark along its direction from its views, by a scan: a start for the joint
/// optimization. Where the views do not tell, that of a far point. `pixel_sigma`: image noise [px].
double findInverseDistance(const BundleLandmark& landmark, const std::vector<BundlePose>& poses, double pixel_sigma);

}  // namespace multicam_egomotion
