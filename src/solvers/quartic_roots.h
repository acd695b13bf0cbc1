// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace multicam_egomotion {

/// Up to four real roots; those not in use are zero.
struct QuarticRoots {
  alignas(32) double x[4] = {};
  int count = 0;
};

/// Finite real roots of c[4] x⁴ + c[3] x³ + c[2] x² + c[1] x + c[0], or of the cubic if c[4] is exactly zero, in closed
/// form: Ferrari's two quadratics with the resolvent cubic by Cardano. Cancellation may have cost half their digits:
/// they want Newton steps. A double root appears once, twice or, to rounding, not at all. Coefficients that are not
/// finite have no roots.
QuarticRoots quarticRootsInClosedForm(const double* c);

}  // namespace multicam_egomotion
