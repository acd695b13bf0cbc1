// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pybind11/pybind11.h>

namespace multicam_egomotion {

/// Camera, CameraRig; rays from pixels and from bearings.
void bindRig(pybind11::module_& module);
/// Priors, solve().
void bindSolvers(pybind11::module_& module);
/// Options, MotionPriors, estimate(), estimate_from_pixels(). After the other two.
void bindEstimator(pybind11::module_& module);

}  // namespace multicam_egomotion
