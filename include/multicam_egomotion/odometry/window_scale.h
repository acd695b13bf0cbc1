// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "multicam_egomotion/estimation/bundle_adjustment.h"

namespace multicam_egomotion {

/// Whether enough landmarks are seen by two cameras at once, whose distances tell the scale.
bool overlapShowsScale(const BundleAdjustment& bundle);

/// Tries other scales of all motion and points of an adjustment that has been solved, and takes over what fits better.
/// Cameras without overlap see the scale only through rotation: steps of the adjustment along it are short, and from a
/// start that is far off they end long before it is found. Nothing is tried where cameras overlap.
/// `bundle`: poses and points in odom, scaled about the first pose; `summary`: of its last solution. Both stay as they
/// are where no other scale fits better.
void findScale(const BundleOptions& options, BundleAdjustment* bundle, BundleSummary* summary);

}  // namespace multicam_egomotion
