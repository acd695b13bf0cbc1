// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "multicam_egomotion/solvers/four_point_axis.h"

#include "multicam_egomotion/solvers/four_point_kernel.h"

namespace multicam_egomotion {

PoseCandidates<6> solveFourPointAxis(const std::array<RayCorrespondence, 4>& sample, const AxisPrior& prior,
                                     const SolverOptions& options) {
  PoseCandidates<6> candidates;
  if (!prior.axis.allFinite()) {
    candidates.status = SolverStatus::kInvalidInput;
  } else if (!(prior.axis.squaredNorm() > 1e-24)) {
    candidates.status = SolverStatus::kAxisUndefined;
  } else {
    const Eigen::Matrix3d R_aligned_body = rotationToZ(prior.axis);
    candidates = solveFourPointAboutZ(sample, {R_aligned_body, R_aligned_body, true}, options);
  }
  return candidates;
}

}  // namespace multicam_egomotion
