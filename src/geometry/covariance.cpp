// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "multicam_egomotion/geometry/covariance.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>

namespace multicam_egomotion {

Eigen::MatrixXd propagated(const MatrixRef& F, const MatrixRef& P) {
  const Eigen::MatrixXd FP = F * P;
  const Eigen::MatrixXd all = FP * F.transpose();
  return 0.5 * (all + all.transpose());
}

Eigen::MatrixXd symmetricInverse(const MatrixRef& P) {
  return symmetricSolve(P, Eigen::MatrixXd::Identity(P.rows(), P.cols()));
}

Eigen::MatrixXd symmetricSolve(const MatrixRef& P, const MatrixRef& B) { return P.ldlt().solve(B); }

double squaredMahalanobis(const VectorRef& x, const MatrixRef& P) { return x.dot(symmetricSolve(P, x).col(0)); }

bool isPositiveDefinite(const MatrixRef& P) {
  return P.allFinite() && (P - P.transpose()).norm() <= 1e-9 * P.norm() && P.llt().info() == Eigen::Success;
}

Eigen::VectorXd symmetricEigenvalues(const MatrixRef& P) {
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(P, Eigen::EigenvaluesOnly).eigenvalues();
}

Eigen::MatrixXd withEigenvaluesRaised(const MatrixRef& P, double smallest, double share) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(P);
  const double floor = std::max(smallest, share * eigen.eigenvalues().maxCoeff());
  const Eigen::VectorXd values = eigen.eigenvalues().cwiseMax(floor);
  return propagated(eigen.eigenvectors(), Eigen::MatrixXd(values.asDiagonal()));
}

}  // namespace multicam_egomotion
