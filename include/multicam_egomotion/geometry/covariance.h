// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

// Operations on covariance matrices of any size, compiled once. Each takes what is symmetric for symmetric: it reads
// the lower triangle or returns a matrix that is symmetric to the last bit.
namespace multicam_egomotion {

using VectorRef = Eigen::Ref<const Eigen::VectorXd>;
using MatrixRef = Eigen::Ref<const Eigen::MatrixXd>;

/// F P Fᵀ, symmetric: covariance of F x where P is that of x. F is m by n, P n by n.
Eigen::MatrixXd propagated(const MatrixRef& F, const MatrixRef& P);

/// P⁻¹ of a positive definite P.
Eigen::MatrixXd symmetricInverse(const MatrixRef& P);

/// P⁻¹ B of a symmetric P, n by n, that has no negative eigenvalues beyond rounding; B is n by m.
Eigen::MatrixXd symmetricSolve(const MatrixRef& P, const MatrixRef& B);

/// xᵀ P⁻¹ x, the squared Mahalanobis distance of x from 0.
double squaredMahalanobis(const VectorRef& x, const MatrixRef& P);

/// Whether all is finite, P equals its transpose to 1e-9 of its norm, and it has a Cholesky decomposition.
bool isPositiveDefinite(const MatrixRef& P);

/// Eigenvalues of a symmetric P, ascending.
Eigen::VectorXd symmetricEigenvalues(const MatrixRef& P);

/// P with its eigenvalues raised to at least `smallest` and to at least `share` of the largest; symmetric.
Eigen::MatrixXd withEigenvaluesRaised(const MatrixRef& P, double smallest, double share);

}  // namespace multicam_egomotion
