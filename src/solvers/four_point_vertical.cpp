// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "multicam_egomotion/solvers/four_point_vertical.h"

#include "multicam_egomotion/solvers/four_point_kernel.h"

namespace multicam_egomotion {

PoseCandidates<6> solveFourPointVertical(const std::array<RayCorrespondence, 4>& sample, const VerticalPrior& prior,
                                         const SolverOptions& options) {
  PoseCandidates<6> candidates;
  solveFourPointVertical(&sample, 1, prior, options, &candidates);
  return candidates;
}

void solveFourPointVertical(const std::array<RayCorrespondence, 4>* samples, int count, const VerticalPrior& prior,
                            const SolverOptions& options, PoseCandidates<6>* candidates) {
  // The vertical of frame 1 in the aligned frame 2 is z to rounding: the frames differ in yaw alone, which is free.
  constexpr double kRounding = 1e-12;
  const Eigen::Vector3d up = prior.R_aligned_body2 * prior.R_aligned_body1.row(2).transpose();
  const bool same_tilt = std::abs(up.x()) < kRounding && std::abs(up.y()) < kRounding && up.z() > 0;
  solveFourPointAboutZ(samples, count,
                       {same_tilt ? prior.R_aligned_body2 : prior.R_aligned_body1, prior.R_aligned_body2, same_tilt},
                       options, candidates);
}

}  // namespace multicam_egomotion
