// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "four_point_translation.h"

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <algorithm>

namespace multicam_egomotion {
namespace {

constexpr double kSmallestNormal = 1e-14;  // relative singular value of the normals without which t is not finite

}  // namespace

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

}  // namespace multicam_egomotion
