// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "multicam_egomotion/solvers/four_point_axis.h"

#include "multicam_egomotion/solvers/four_point_kernel.h"

namespace multicam_egomotion {

PoseCandidates<6> solveFourPointAxis(const std::array<RayCorrespondence, 4>& sample, const AxisPrior& prior,
                                     const SolverOptions& options) {
  PoseCandidates<6> candidates;
  solveFourPointAxis(&sample, 1, prior, options, &candidates);
  return candidates;
}

void solveFourPointAxis(const std::array<RayCorrespondence, 4>* samples, int count, const AxisPrior& prior,
                        const SolverOptions& options, PoseCandidates<6>* candidates) {
  const bool finite = prior.axis.allFinite();
  if (!finite || !(prior.axis.squaredNorm() > 1e-24)) {
    for (int i = 0; i < count; ++i) {
      candidates[i].count = 0;
      candidates[i].status = finite ? SolverStatus::kAxisUndefined : SolverStatus::kInvalidInput;
    }
    return;
  }
  const Eigen::Matrix3d R_aligned_body = rotationToZ(prior.axis);
  solveFourPointAboutZ(samples, count, {R_aligned_body, R_aligned_body, true}, options, candidates);
}

}  // namespace multicam_egomotion
