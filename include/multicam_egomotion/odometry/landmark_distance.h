// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "multicam_egomotion/estimation/bundle_adjustment.h"

namespace multicam_egomotion {

/// Inverse distance [1/m] of a landmark along its direction from its views, by a scan: a start for the joint
/// optimization. Where the views do not tell, that of a far point. `bundle`: its poses, calibration and image noise.
double findInverseDistance(const BundleLandmark& landmark, const BundleAdjustment& bundle);

}  // namespace multicam_egomotion
