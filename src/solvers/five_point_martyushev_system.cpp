// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "five_point_martyushev_system.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>

namespace multicam_egomotion {
namespace {

constexpr int kMaxIterations = 12;
constexpr double kConverged = 1e-10;  // step from which the next one is at rounding [rad]
constexpr double kLongestStep = 0.3;  // of the axis [rad]
constexpr double kLargestResidual = 1e-13;
constexpr double kNearCompanion = 0.4;  // [rad]

using RowMajor54 = Eigen::Matrix<double, 5, 4, Eigen::RowMajor>;
using Functions = Eigen::Matrix<double, 9, 1>;

AxisSystem::Matrix54 asMatrix(const Eigen::Matrix<double, 20, 1>& entries) {
  return Eigen::Map<const RowMajor54>(entries.data());
}

/// A fixed turn: then no axis of a rig or a vehicle is special to the functions on the sphere.
const Eigen::Matrix3d& turn() {
  static const Eigen::Matrix3d result = Eigen::AngleAxisd(1.1, Eigen::Vector3d(0.36, 0.48, 0.8)).toRotationMatrix();
  return result;
}

}  // namespace

/// Tangent coordinates about a solution: two of the axis, three of the null vector with its largest entry fixed.
struct AxisSystem::Chart {
  Eigen::Vector3d e1, e2;
  int free[3];
  Matrix54 m;
  Matrix5 jacobian;

  Eigen::Vector3d axisStep(const Vector5& d) const { return d(0) * e1 + d(1) * e2; }
  Eigen::Vector4d vectorStep(const Vector5& d) const {
    Eigen::Vector4d step = Eigen::Vector4d::Zero();
    for (int i = 0; i < 3; ++i) step(free[i]) = d(2 + i);
    return step;
  }
};

AxisSystem::AxisSystem(const std::array<RayCorrespondence, 5>& sample, double angle) : angle_(angle) {
  // Constraints for a linear map E in place of R: E = I, [e_k]×, e_k e_lᵀ.
  double size = 0;
  std::array<RayCorrespondence, 5> turned = sample;
  for (RayCorrespondence& ray : turned) {
    size = std::max({size, ray.first.moment.norm(), ray.second.moment.norm()});
    for (Ray* side : {&ray.first, &ray.second}) *side = {turn() * side->direction, turn() * side->moment};
  }
  const double unit = size > 0 ? 1 / size : 1;
  const auto constraints = [&](const auto& map) {
    Matrix54 m;
    for (int i = 0; i < 5; ++i) {
      const Eigen::Vector3d x = map(turned[i].first.direction), q = map(turned[i].first.moment);
      const Eigen::Vector3d &x2 = turned[i].second.direction, &q2 = turned[i].second.moment;
      m.row(i) << x.cross(x2).transpose(), unit * (x.dot(q2) + x2.dot(q));
    }
    return m;
  };
  const Matrix54 identity = constraints([](const Eigen::Vector3d& x) { return x; });
  if (!identity.allFinite()) {
    coefficients_.setConstant(std::numeric_limits<double>::quiet_NaN());
    return;
  }

  // R - I is of the order of the angle: rows and columns in which M(I) is smaller are enlarged.
  const Eigen::JacobiSVD<Matrix54, Eigen::FullPivHouseholderQRPreconditioner> svd(
      identity, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Vector4d sigma = svd.singularValues();
  const double largest = sigma(0) > 0 ? sigma(0) : 1;
  singular_values_ = sigma / largest;
  Matrix5 rows = svd.matrixU().transpose();
  columns_ = svd.matrixV();
  for (int i = 0; i < 5; ++i) {
    const double weight = 1 / std::sqrt(std::max(i < 4 ? singular_values_(i) : 0.0, angle));
    rows.row(i) *= weight;
    if (i < 4) columns_.col(i) *= weight / largest;
  }

  const double s = std::sin(angle), versine = 2 * std::sin(angle / 2) * std::sin(angle / 2);
  const auto set = [&](int function, double factor, const Matrix54& m) {
    RowMajor54 entries = factor * (rows * m * columns_);
    coefficients_.col(function) = Eigen::Map<const Eigen::Matrix<double, 20, 1>>(entries.data());
  };
  Matrix54 dyads[3][3];
  for (int k = 0; k < 3; ++k) {
    const Eigen::Vector3d e = Eigen::Vector3d::Unit(k);
    set(1 + k, s, constraints([&](const Eigen::Vector3d& x) { return Eigen::Vector3d(e.cross(x)); }));
    for (int l = 0; l < 3; ++l) {
      dyads[k][l] = constraints([&](const Eigen::Vector3d& x) { return Eigen::Vector3d(e * x(l)); });
    }
  }
  const Matrix54 constant = std::cos(angle) * identity + versine * dyads[2][2];
  set(0, 1, constant);
  set(4, versine, dyads[0][0] - dyads[2][2]);
  set(5, versine, dyads[1][1] - dyads[2][2]);
  set(6, versine, dyads[0][1] + dyads[1][0]);
  set(7, versine, dyads[0][2] + dyads[2][0]);
  set(8, versine, dyads[1][2] + dyads[2][1]);
  columns_.row(3) *= unit;
  columns_.topRows<3>() = (turn().transpose() * columns_.topRows<3>()).eval();
}

AxisSystem::Matrix54 AxisSystem::at(const Eigen::Vector3d& n) const {
  Functions f;
  f << 1, n.x(), n.y(), n.z(), n.x() * n.x(), n.y() * n.y(), n.x() * n.y(), n.x() * n.z(), n.y() * n.z();
  return asMatrix(coefficients_ * f);
}

AxisSystem::Matrix54 AxisSystem::derivative(const Eigen::Vector3d& n, const Eigen::Vector3d& d) const {
  Functions f;
  f << 0, d.x(), d.y(), d.z(), 2 * n.x() * d.x(), 2 * n.y() * d.y(), n.x() * d.y() + d.x() * n.y(),
      n.x() * d.z() + d.x() * n.z(), n.y() * d.z() + d.y() * n.z();
  return asMatrix(coefficients_ * f);
}

Eigen::Matrix3d AxisSystem::rotation(const Eigen::Vector3d& axis) const {
  return Eigen::AngleAxisd(angle_, turn().transpose() * axis).toRotationMatrix();
}

AxisSystem::Solution AxisSystem::start(const Eigen::Vector3d& axis) const {
  Solution solution;
  solution.axis = axis.normalized();
  const Matrix54 m = at(solution.axis);
  Eigen::Matrix4d normal = m.transpose() * m;
  normal.diagonal().array() += 1e-14 * normal.trace();
  const Eigen::PartialPivLU<Eigen::Matrix4d> lu(normal);
  solution.v = lu.solve(Eigen::Vector4d(1, 0.9, 0.8, 0.7)).normalized();
  for (int i = 0; i < 2; ++i) solution.v = lu.solve(solution.v).normalized();
  return solution;
}

void AxisSystem::jacobian(const Solution& solution, Chart& chart) const {
  chart.e1 = solution.axis.unitOrthogonal();
  chart.e2 = solution.axis.cross(chart.e1);
  int fixed;
  solution.v.cwiseAbs().maxCoeff(&fixed);
  chart.m = at(solution.axis);
  chart.jacobian.col(0) = derivative(solution.axis, chart.e1) * solution.v;
  chart.jacobian.col(1) = derivative(solution.axis, chart.e2) * solution.v;
  for (int i = 0, j = 0; j < 4; ++j) {
    if (j == fixed) continue;
    chart.free[i] = j;
    chart.jacobian.col(2 + i++) = chart.m.col(j);
  }
}

bool AxisSystem::refine(Solution& solution) const {
  Chart chart;
  bool converged = false;
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    jacobian(solution, chart);
    const Vector5 residual = chart.m * solution.v;
    Vector5 step = chart.jacobian.partialPivLu().solve(-residual);
    const double turn = std::hypot(step(0), step(1));
    if (!(turn < 1e6)) return false;
    if (turn > kLongestStep) step *= kLongestStep / turn;
    solution.axis = (solution.axis + chart.axisStep(step)).normalized();
    solution.v = (solution.v + chart.vectorStep(step)).normalized();
    if (converged) break;
    converged = turn < kConverged;
  }
  const Matrix54 m = at(solution.axis);
  return (m * solution.v).norm() <= kLargestResidual * m.norm();
}

bool AxisSystem::companion(const Solution& solution, Solution& other) const {
  Chart chart;
  jacobian(solution, chart);
  // Singular vectors of the smallest singular value: along w the system is σ s + c s² to second order.
  const Eigen::PartialPivLU<Matrix5> lu(chart.jacobian);
  Vector5 w = Vector5::Ones(), u;
  for (int i = 0; i < 3; ++i) {
    u = lu.transpose().solve(w).normalized();
    w = lu.solve(u).normalized();
  }
  if (!w.allFinite()) return false;
  const Eigen::Vector3d d = chart.axisStep(w), &n = solution.axis;
  Functions second;
  second << 0, 0, 0, 0, d.x() * d.x(), d.y() * d.y(), d.x() * d.y(), d.x() * d.z(), d.y() * d.z();
  const Matrix54 curvature = asMatrix(coefficients_ * second) - 0.5 * d.squaredNorm() * derivative(n, n);
  const double slope = u.dot(chart.jacobian * w);
  const double bend = u.dot(curvature * solution.v + derivative(n, d) * chart.vectorStep(w));
  const double s = -slope / bend;
  if (!(std::abs(s) * d.norm() < kNearCompanion) || !(std::abs(s) < 2)) return false;
  other.axis = (n + s * d).normalized();
  other.v = (solution.v + s * chart.vectorStep(w)).normalized();
  return true;
}

}  // namespace multicam_egomotion
