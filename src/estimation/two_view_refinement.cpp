// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "multicam_egomotion/estimation/two_view_refinement.h"

#include <Eigen/Cholesky>
#include <cmath>

#include "multicam_egomotion/geometry/so3.h"

namespace multicam_egomotion {
namespace {

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

struct Problem {
  const CorrespondenceSet& set;
  const std::vector<int>& inliers;
  const RotationPrior& prior;
  const TwoViewRefinementOptions& options;

  // Signed Sampson error [px] of one correspondence and, when asked, its gradient by (d t, d theta) with R <- Exp(d
  // theta) R.
  double error(int position, const Eigen::Matrix3d& R, const Eigen::Vector3d& t, Vector6d* gradient) const {
    const int index = set.indexAt(position);
    const CorrespondenceSet::CameraPair& pair = set.cameraPairs()[set.pairOf(index)];
    const RayCorrespondence& rays = set.rays(index);
    const Eigen::Vector3d center = R * pair.center1;
    const Eigen::Vector3d baseline = center + t - pair.center2;
    const Eigen::Vector3d d1 = R * rays.first.direction;
    const Eigen::Vector3d& d2 = rays.second.direction;
    const Eigen::Vector3d n2 = baseline.cross(d1);
    const Eigen::Vector3d n1 = d2.cross(baseline);
    const double e = d2.dot(n2);
    const double k1 = set.inverseSquaredScale1(position), k2 = set.inverseSquaredScale2(position);
    const double inverse = 1.0 / std::sqrt((n2.squaredNorm() - e * e) * k2 + (n1.squaredNorm() - e * e) * k1 + 1e-30);
    if (gradient) {
      // Numerator and denominator: with the denominator held, every baseline would seem to fit better the shorter it
      // is.
      const double shrink = e * inverse * inverse * inverse;
      const double numerator = inverse + shrink * e * (k1 + k2);
      const Eigen::Vector3d by_baseline = numerator * d1.cross(d2) - shrink * (k2 * d1.cross(n2) + k1 * n1.cross(d2));
      const Eigen::Vector3d by_direction = numerator * d2.cross(baseline) - (shrink * k2) * n2.cross(baseline);
      gradient->head<3>() = by_baseline;
      gradient->tail<3>() = center.cross(by_baseline) + d1.cross(by_direction);
    }
    return e * inverse;
  }

  double cost(const Eigen::Matrix3d& R, const Eigen::Vector3d& t) const {
    const double w2 = options.robust_width_px * options.robust_width_px;
    double sum = 0.0;
    for (int position : inliers) {
      const double e = error(position, R, t, nullptr);
      sum += 0.5 * w2 * std::log1p(e * e / w2);
    }
    const Eigen::Vector3d d = logSO3(R * prior.R.transpose());
    return sum / (options.pixel_sigma * options.pixel_sigma) + 0.5 * d.dot(prior.information * d);
  }
};

}  // namespace

bool refineTwoView(const CorrespondenceSet& set, const std::vector<int>& inliers, const RotationPrior& prior,
                   const TwoViewRefinementOptions& options, Eigen::Matrix3d* R, Eigen::Vector3d* t) {
  const Problem problem{set, inliers, prior, options};
  const double information = 1.0 / (options.pixel_sigma * options.pixel_sigma);
  const double w2 = options.robust_width_px * options.robust_width_px;
  Eigen::Matrix3d best_R = *R;
  Eigen::Vector3d best_t = *t;
  double best_cost = problem.cost(best_R, best_t);
  if (!std::isfinite(best_cost)) return false;

  double lambda = 1e-4;
  for (int iteration = 0; iteration < options.max_iterations; ++iteration) {
    Matrix6d H = Matrix6d::Zero();
    Vector6d b = Vector6d::Zero(), gradient;
    for (int position : inliers) {
      const double e = problem.error(position, best_R, best_t, &gradient);
      const double weight = information / (1.0 + e * e / w2);
      H.selfadjointView<Eigen::Lower>().rankUpdate(gradient, weight);
      b -= (weight * e) * gradient;
    }
    H = H.selfadjointView<Eigen::Lower>();
    const Eigen::Vector3d d = logSO3(best_R * prior.R.transpose());
    H.bottomRightCorner<3, 3>() += prior.information;
    b.tail<3>() -= prior.information * d;
    H.diagonal() *= 1.0 + lambda;
    H.diagonal().array() += 1e-9;
    const Vector6d step = H.ldlt().solve(b);
    if (!step.allFinite()) return false;

    const Eigen::Matrix3d new_R = expSO3(step.tail<3>()) * best_R;
    const Eigen::Vector3d new_t = best_t + step.head<3>();
    const double new_cost = problem.cost(new_R, new_t);
    if (!(new_cost < best_cost)) {
      lambda *= 10.0;
      continue;
    }
    const bool converged = best_cost - new_cost < 1e-5 * best_cost;
    best_R = new_R;
    best_t = new_t;
    best_cost = new_cost;
    lambda *= 0.1;
    if (converged) break;
  }
  *R = Eigen::Quaterniond(best_R).normalized().toRotationMatrix();
  *t = best_t;
  return true;
}

}  // namespace multicam_egomotion
