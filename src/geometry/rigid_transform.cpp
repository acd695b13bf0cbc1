// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "multicam_egomotion/geometry/rigid_transform.h"

#include <Eigen/SVD>
#include <sstream>
#include <stdexcept>

namespace multicam_egomotion {

Eigen::Isometry3d rigidTransform(const Eigen::Matrix4d& matrix) {
  constexpr double kTolerance = 1e-3;
  const Eigen::Matrix3d R = matrix.topLeftCorner<3, 3>();
  const double deviation = (R.transpose() * R - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (!matrix.allFinite() || deviation > kTolerance || R.determinant() < 0 ||
      matrix.row(3) != Eigen::RowVector4d(0, 0, 0, 1)) {
    std::ostringstream text;
    text << "is not a rigid motion: R'R differs from the identity by " << deviation << ", det R is " << R.determinant()
         << ", the last row is " << matrix.row(3)
         << ", expected a rotation matrix, a translation [m] and the last row 0 0 0 1";
    throw std::invalid_argument(text.str());
  }
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(R, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = svd.matrixU() * svd.matrixV().transpose();
  T.translation() = matrix.topRightCorner<3, 1>();
  return T;
}

}  // namespace multicam_egomotion
