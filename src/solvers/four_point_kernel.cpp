// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "multicam_egomotion/solvers/four_point_kernel.h"

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "instruction_sets.h"

#pragma GCC diagnostic ignored "-Wpsabi"

namespace multicam_egomotion {
namespace {

constexpr double kRankTolerance = 1e-6;    // below this F is looked at again with all four rows
constexpr double kScaleTolerance = 1e-7;   // sine of the rotation, or relative singular value, without scale
constexpr double kNoParallax = 1e-7;       // [rad]
constexpr double kSmallestNormal = 1e-14;  // relative singular value of the normals without which t is not finite
constexpr double kVanishing = 1e-14;       // rounding of a determinant of rows of order 1
constexpr double kLargestSquare = 1e280;

struct SampleClass {
  bool central;        // all of one camera pair
  bool three_and_one;  // lanes 0 to 2 share a camera pair, lane 3 is of another
  bool same_tilt;      // R1 and R2 are equal
};

struct AlignedRays {
  Eigen::Matrix<double, 3, 4> x1, x2;  // directions
  Eigen::Matrix<double, 3, 4> p1, p2;  // points of the rays
};

/// Translation where the depths of the origin do not give it: least squares on m · (t - (p2 - R p1)) = 0,
/// m = R x1 × x2, of all four correspondences. Scale is not observable where constants and normals together have
/// rank 2. Returns false where not even the direction is determined.
bool translationFromAllRows(const AlignedRays& rays, double c, double s, double* t, bool& scale_observable) {
  Eigen::Matrix3d R;
  R << c, -s, 0, s, c, 0, 0, 0, 1;
  const double size = std::max(rays.p1.colwise().norm().maxCoeff(), rays.p2.colwise().norm().maxCoeff());
  Eigen::Matrix4d rows = Eigen::Matrix4d::Zero();
  int used = 0;
  for (int i = 0; i < 4; ++i) {
    const Eigen::Vector3d m = (R * rays.x1.col(i)).cross(rays.x2.col(i));
    const double parallax = m.norm() / (rays.x1.col(i).norm() * rays.x2.col(i).norm());
    if (!(parallax > kNoParallax)) continue;
    rows.row(used).head<3>() = m.normalized();
    rows(used, 3) = rows.row(used).head<3>().dot(R * rays.p1.col(i) - rays.p2.col(i)) / (size > 0 ? size : 1.0);
    ++used;
  }
  Eigen::Map<Eigen::Vector3d> translation(t);
  if (used == 0) {
    translation.setZero();
    scale_observable = false;
    return true;
  }
  const Eigen::JacobiSVD<Eigen::Matrix4d> all(rows);
  const Eigen::JacobiSVD<Eigen::Matrix<double, 4, 3>, Eigen::FullPivHouseholderQRPreconditioner> normals(
      rows.leftCols<3>(), Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Vector3d sigma = normals.singularValues();
  if (sigma(1) <= kScaleTolerance * sigma(0)) return false;
  scale_observable = all.singularValues()(2) > kScaleTolerance * all.singularValues()(0);
  if (!scale_observable) {
    translation = normals.matrixV().col(2);
    return true;
  }
  if (sigma(2) <= kSmallestNormal * sigma(0)) return false;
  translation = -size * normals.solve(rows.col(3));
  return translation.allFinite();
}

namespace build_instructions {
#include "real_roots.inc"
//
#include "four_point_lanes.inc"
//
#include "four_point_solve.inc"
}  // namespace build_instructions

#if MULTICAM_EGOMOTION_DISPATCH_AVX2
#pragma GCC push_options
#pragma GCC target("avx2,fma")
namespace avx2_instructions {
#include "real_roots.inc"
//
#include "four_point_lanes.inc"
//
#include "four_point_solve.inc"
}  // namespace avx2_instructions
#pragma GCC pop_options
#endif

bool isRotation(const Eigen::Matrix3d& R) {
  return std::abs(R.squaredNorm() - 3.0) < 1e-6 && std::abs(R.determinant() - 1.0) < 1e-6;
}

bool samePair(const RayCorrespondence& a, const RayCorrespondence& b) {
  return a.camera1 == b.camera1 && a.camera2 == b.camera2;
}

}  // namespace

PoseCandidates<6> solveFourPointAboutZ(const std::array<RayCorrespondence, 4>& sample, const ZAlignedFrames& frames,
                                       const SolverOptions& options) {
  PoseCandidates<6> candidates;
  if (!isRotation(frames.R_aligned_body1) || !isRotation(frames.R_aligned_body2)) {
    candidates.status = SolverStatus::kInvalidInput;
    return candidates;
  }
  const RayCorrespondence* ordered[4] = {&sample[0], &sample[1], &sample[2], &sample[3]};
  for (const RayCorrespondence& ray : sample) {
    if (options.camera_centers != nullptr && (ray.camera1 < 0 || ray.camera1 >= options.camera_count ||
                                              ray.camera2 < 0 || ray.camera2 >= options.camera_count)) {
      candidates.status = SolverStatus::kInvalidInput;
      return candidates;
    }
  }
  // The correspondence whose pair the three others share goes last; the origin is one of the three.
  const bool same01 = samePair(sample[0], sample[1]), same23 = samePair(sample[2], sample[3]);
  const bool same02 = samePair(sample[0], sample[2]), same13 = samePair(sample[1], sample[3]);
  int odd = -1;
  if (same01 && same02) odd = 3;
  if (same01 && same13) odd = 2;
  if (same23 && same02) odd = 1;
  if (same23 && same13) odd = 0;
  const bool central = same01 && same23 && same02;
  const SampleClass sample_class = {central, odd >= 0 && !central, frames.same_tilt};
  if (sample_class.three_and_one) std::swap(ordered[odd], ordered[3]);

  // R = cosθ P + sinθ Q + W
  const Eigen::Matrix3d &R1 = frames.R_aligned_body1, &R2 = frames.R_aligned_body2;
  Eigen::Matrix3d pqw[3];
  pqw[0] = R2.row(0).transpose() * R1.row(0) + R2.row(1).transpose() * R1.row(1);
  pqw[1] = R2.row(1).transpose() * R1.row(0) - R2.row(0).transpose() * R1.row(1);
  pqw[2] = R2.row(2).transpose() * R1.row(2);

#if MULTICAM_EGOMOTION_DISPATCH_AVX2
  if (processorHasAvx2()) {
    candidates.status =
        avx2_instructions::solve(ordered, sample_class, R1.data(), R2.data(), pqw[0].data(), options, candidates);
  } else
#endif
  {
    candidates.status =
        build_instructions::solve(ordered, sample_class, R1.data(), R2.data(), pqw[0].data(), options, candidates);
  }
  return candidates;
}

std::array<double, 7> fourPointPolynomial(const std::array<RayCorrespondence, 4>& sample,
                                          const ZAlignedFrames& frames) {
  const RayCorrespondence* const rays[4] = {&sample[0], &sample[1], &sample[2], &sample[3]};
  build_instructions::AlignedSample aligned;
  build_instructions::alignSample(rays, frames.R_aligned_body1.data(), frames.R_aligned_body2.data(), false, aligned);
  build_instructions::expandDeterminant(aligned);
  std::array<double, 7> coefficients;
  std::copy(aligned.coefficients, aligned.coefficients + 7, coefficients.begin());
  return coefficients;
}

}  // namespace multicam_egomotion
