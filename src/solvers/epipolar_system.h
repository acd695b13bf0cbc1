// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>

#include "multicam_egomotion/geometry/ray.h"
#include "multicam_egomotion/solvers/relative_pose.h"
#include "multicam_egomotion/solvers/solver_priors.h"

namespace multicam_egomotion {

using Lanes = Eigen::Array4d;              ///< one number of each correspondence
using LaneVectors = std::array<Lanes, 3>;  ///< x, y and z of four vectors

LaneVectors cross(const LaneVectors& a, const LaneVectors& b);

/// Half of a rotation angle about z as a unit vector: θ = 2 atan2(b, a), s = tan(θ / 2) = b / a.
struct HalfAngle {
  double a = 1;
  double b = 0;
};

HalfAngle normalized(double a, double b);

/// The classical formulation: the generalized epipolar constraints (paper, equation b2) of four correspondences as
/// M(θ) [t / size; 1] = 0 with M(θ) = cosθ c + sinθ s + k, in frames that differ by the rotation Rz(θ). A row is
///   [Rz x1 × x2,  (x2 · Rz q1 + q2 · Rz x1) / size],
/// the directions of the rays having been normalized.
struct EpipolarSystem {
  Eigen::Matrix4d c, s, k;
  double size;          ///< largest moment [m]
  bool three_and_one;   ///< rows 0 to 2 share a camera pair: det of their normals takes the place of det M
  bool identity_root;   ///< R = I, t = 0 is a solution: the last column of M(0) is zero (exactly: k = -c)
  bool standing_still;  ///< identity_root, and no ray moves
  Eigen::Matrix3d R_aligned_body1, R_aligned_body2;
  LaneVectors x1, x2;  ///< unit directions in the aligned frames
  LaneVectors p1, p2;  ///< points of the rays from which depths count [m]
};

bool onePair(const std::array<RayCorrespondence, 4>& sample);

/// The vertical of frame 1 in the aligned frame 2 is z to rounding: the frames differ in yaw alone, which is free.
bool sameTilt(const VerticalPrior& prior);

/// Status kInvalidInput, or kCentral where all correspondences share a camera pair; else kOk.
SolverStatus buildEpipolarSystem(const std::array<RayCorrespondence, 4>& sample, const VerticalPrior& prior,
                                 const SolverOptions& options, EpipolarSystem& system);

/// M at one angle. Of a system with the identity root the last column is divided by `factor` = 2 sin(θ / 2).
struct SystemAtAngle {
  Eigen::Matrix4d rows;
  Eigen::Matrix4d row_slopes;  ///< derivative of `rows` by θ
  double factor;
  double value;  ///< zero at a solution: det of `rows`, or of the normals of rows 0 to 2 (three_and_one)
  double slope;  ///< derivative of `value` by θ
};

SystemAtAngle evaluate(const EpipolarSystem& system, const HalfAngle& half);

/// Rounding error of SystemAtAngle::value.
double roundingError(const EpipolarSystem& system, const SystemAtAngle& at);

/// det M (with three_and_one, or that of the normals of rows 0 to 2) is zero to rounding at eight angles all round: the
/// sample does not determine the pose.
bool vanishes(const EpipolarSystem& system);

/// Of the eight angles the one at which that determinant is largest.
HalfAngle farthestFromSingular(const EpipolarSystem& system);

/// Adjugate of a 4x4 matrix, transposed: a matrix of rank 3 has its null vector in each row that is not zero.
Eigen::Matrix4d cofactorMatrix(const Eigen::Matrix4d& m);

}  // namespace multicam_egomotion
