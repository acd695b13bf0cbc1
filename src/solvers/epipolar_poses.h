// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>

#include "epipolar_system.h"
#include "multicam_egomotion/solvers/relative_pose.h"

namespace multicam_egomotion {

/// An angle near which det M(θ) = 0 was found. `touching`: where it comes near zero without a certain change of sign,
/// so that there are two solutions, one or none.
struct AngleEstimate {
  HalfAngle half;
  bool touching;
};

struct AngleEstimates {
  std::array<AngleEstimate, 8> angles;
  int count = 0;

  void add(const HalfAngle& half, bool touching) {
    if (count < 8) angles[count++] = {half, touching};
  }
};

/// The poses at the roots of det M(θ) nearest the estimates, each once: the estimates are refined by Newton steps on
/// det M itself, whose rounding error is smaller than that of its expanded polynomial.
void posesAtRoots(const EpipolarSystem& system, AngleEstimates& estimates, const SolverOptions& options,
                  PoseCandidates<8>& candidates);

/// Translation of the rotation at `half` from the null vector of `rows` (last column divided by `factor`, which is zero
/// where the scale is not observable) and its cofactors; false where it is not determined or, with
/// positive_depths_only, puts a point behind one of its rays.
bool poseFromRows(const EpipolarSystem& system, const HalfAngle& half, const Eigen::Matrix4d& rows,
                  const Eigen::Matrix4d& cofactors, double factor, const SolverOptions& options, RelativePose& pose);

/// No point of the sample lies behind one of its rays; t in the aligned frame at t2; without its scale the
/// camera centres are taken to coincide.
bool depthsArePositive(const EpipolarSystem& system, const HalfAngle& half, const Eigen::Vector3d& t_aligned,
                       bool scale_observable);

/// R = I, t = 0 without scale: what is seen by a system that stands still.
RelativePose standingStill();

}  // namespace multicam_egomotion
