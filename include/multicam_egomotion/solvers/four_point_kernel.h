// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>

#include "multicam_egomotion/geometry/ray.h"
#include "multicam_egomotion/solvers/relative_pose.h"

namespace multicam_egomotion {

/// Two rotations of the body, at t1 and at t2, into frames that differ by a rotation about their common z axis.
struct ZAlignedFrames {
  Eigen::Matrix3d R_aligned_body1;
  Eigen::Matrix3d R_aligned_body2;
  bool same_tilt;  ///< both matrices are equal: R = I is one of the possible rotations, at s = 0
};

/// The kernel of solveFourPointVertical and solveFourPointAxis: R = R_aligned_body2ᵀ Rz(2 atan s) R_aligned_body1.
/// `candidates` of each of `count` samples; in blocks of eight, which take less time than one after the other.
void solveFourPointAboutZ(const std::array<RayCorrespondence, 4>* samples, int count, const ZAlignedFrames& frames,
                          const SolverOptions& options, PoseCandidates<6>* candidates);

/// Coefficients of det F(s), constant term first (paper, equation d5), with the first correspondence as origin.
std::array<double, 7> fourPointPolynomial(const std::array<RayCorrespondence, 4>& sample, const ZAlignedFrames& frames);

}  // namespace multicam_egomotion
