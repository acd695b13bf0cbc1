// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "four_point_translation.h"

#include <Eigen/Geometry>
#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

namespace multicam_egomotion {
namespace {

constexpr double kLargestCorrection = 1e-7;  // [rad]
constexpr double kSmallestNormal = 1e-14;    // relative singular value of the normals without which t is not finite

}  // namespace

bool leastSquaresTranslation(const Eigen::Matrix4d& rows, Eigen::Vector3d& t, bool& scale_observable) {
  t.setZero();
  scale_observable = false;
  if (rows.leftCols<3>().isZero(0)) return true;
  Eigen::JacobiSVD<Eigen::Matrix4d> svd(rows);
  const Eigen::Vector4d sigma_all = svd.singularValues();
  Eigen::Matrix4d normals = rows;  // square, as the one type of all decompositions
  normals.col(3).setZero();
  svd.compute(normals, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Vector4d sigma = svd.singularValues();
  if (!(sigma(1) > kScaleTolerance * sigma(0))) return false;
  scale_observable = sigma_all(2) > kScaleTolerance * sigma_all(0);
  if (!scale_observable) {
    t = svd.matrixV().col(2).head<3>();
    return true;
  }
  if (!(sigma(2) > kSmallestNormal * sigma(0))) return false;
  t = -svd.solve(rows.col(3)).head<3>();
  return t.allFinite();
}

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
  Eigen::Vector3d found;
  if (!leastSquaresTranslation(rows, found, scale_observable)) return false;
  translation = scale_observable ? Eigen::Vector3d(size * found) : found;
  return translation.allFinite();
}

double correctPose(const AlignedRays& rays, double c, double s, double* t) {
  constexpr double kWeak = 1e-9;  // relative pivot below which a direction is left alone
  Eigen::Matrix3d R;
  R << c, -s, 0, s, c, 0, 0, 0, 1;
  Eigen::Map<Eigen::Vector3d> translation(t);
  Eigen::Matrix4d jacobian;
  Eigen::Vector4d residuals;
  for (int i = 0; i < 4; ++i) {
    const Eigen::Vector3d x1 = R * rays.x1.col(i), p1 = R * rays.p1.col(i), x2 = rays.x2.col(i);
    const Eigen::Vector3d m = x1.cross(x2), apart = translation + p1 - rays.p2.col(i);
    const Eigen::Vector3d turned = Eigen::Vector3d::UnitZ().cross(x1).cross(x2);
    residuals(i) = m.dot(apart);
    jacobian.row(i) << m.transpose(), turned.dot(apart) + m.dot(Eigen::Vector3d::UnitZ().cross(p1));
  }
  Eigen::ColPivHouseholderQR<Eigen::Matrix4d> qr(jacobian);
  qr.setThreshold(kWeak);
  const Eigen::Vector4d step = -qr.solve(residuals);
  if (!(std::abs(step(3)) < kLargestCorrection)) return 0;
  translation += step.head<3>();
  return step(3);
}

}  // namespace multicam_egomotion
