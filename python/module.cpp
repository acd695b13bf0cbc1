// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include <pybind11/pybind11.h>

#include "bindings.h"

PYBIND11_MODULE(multicam_egomotion_solvers, module) {
  module.doc() = R"(Relative pose of a multi-camera rig whose vertical, rotation axis or rotation angle is known.

T_f2_f1 = [R t] maps the body at t1 into the body at t2: p_t2 = R p_t1 + t, metres. Rays are Pluecker lines in the body
frame, arrays of shape (n, 6): direction x from the camera towards the point, moment q = camera centre x direction.
A ray correspondence is a row of `rays1` (t1) and one of `rays2` (t2), with the index of the camera that saw it in
`cameras1` and `cameras2`, arrays of shape (n,) or one index for all.

Wrong arguments raise TypeError or ValueError, which say what was found and what was expected.)";
  multicam_egomotion::bindRig(module);
  multicam_egomotion::bindSolvers(module);
  multicam_egomotion::bindEstimator(module);
}
