// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "multicam_egomotion/estimation/two_view_normal_equations.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "multicam_egomotion/geometry/so3.h"
#include "sampson_kernels.h"

namespace multicam_egomotion {
namespace {
constexpr double kWeakestInformation = 1e-6;  // of what nothing tells [1/m^2, 1/rad^2]
}

Eigen::Matrix<double, 6, 1> TwoViewNormalEquations::step(double lambda) const {
  Eigen::Matrix<double, 6, 6> damped = H;
  damped.diagonal() *= 1.0 + lambda;
  return -damped.llt().solve(g);
}

std::vector<double> baselineTrust(const std::vector<RaySegment>& segments, const Eigen::Matrix3d& R,
                                  const Eigen::Vector3d& t, const Eigen::Matrix<double, 6, 6>& covariance) {
  std::vector<double> trust;
  for (const RaySegment& segment : segments) {
    const Eigen::Vector3d center = R * segment.center1;
    Eigen::Matrix<double, 3, 6> D;
    D << Eigen::Matrix3d::Identity(), -skew(center);
    const double square = (center + t - segment.center2).squaredNorm();
    const double variance = (D * covariance * D.transpose()).trace();
    trust.push_back(square / (square + variance));
  }
  const double best = trust.empty() ? 0.0 : *std::max_element(trust.begin(), trust.end());
  for (double& one : trust) one = best > 0.0 ? one / best : 1.0;
  return trust;
}

template <class T>
TwoViewNormalEquations linearizeTwoView(const RayBlocks<T>& rays, bool probe_only, const TwoViewNoise& noise,
                                        const MotionPriors& priors, const Eigen::Matrix3d& R, const Eigen::Vector3d& t,
                                        const std::vector<double>& shares) {
  TwoViewNormalEquations equations;
  equations.H.setZero();
  equations.information.setZero();
  equations.g.setZero();
  equations.shares.assign(rays.segments.size(), 0.0);
  double loss = 0.0;
  for (std::size_t k = 0; k < rays.segments.size(); ++k) {
    const RaySegment& segment = rays.segments[k];
    const Eigen::Vector3d center = R * segment.center1;
    const Eigen::Vector3d baseline = center + t - segment.center2;
    const double length = baseline.norm();
    const int blocks = (probe_only ? segment.probe : segment.end) - segment.begin;
    const PairGeometry geometry{R, length < kNoBaseline ? Eigen::Vector3d::Zero() : Eigen::Vector3d(baseline / length)};
    PairSums sums;
    accumulate(rays.blocks.data() + segment.begin, blocks, geometry, noise.loss, &sums);
    loss += sums.loss;
    equations.core_weight += sums.core_weight;
    equations.core_squares += sums.core_squares;
    if (length < kNoBaseline) continue;

    // From the unit baseline and the rotation about the first centre to t and the rotation about the body:
    // d baseline = d t + d theta × center.
    Eigen::Matrix3d H_bb, H_ab, H_aa;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        const auto at = [&](int row, int column) {
          return row < column ? sums.H[column * (column + 1) / 2 + row] : sums.H[row * (row + 1) / 2 + column];
        };
        H_bb(i, j) = at(i, j) / (length * length);
        H_ab(i, j) = at(3 + i, j) / length;
        H_aa(i, j) = at(3 + i, 3 + j);
      }
    }
    const Eigen::Vector3d g_b = Eigen::Map<const Eigen::Vector3d>(sums.g) / length;
    const Eigen::Matrix3d c = skew(center);
    Eigen::Matrix<double, 6, 6> A = Eigen::Matrix<double, 6, 6>::Identity();
    A.topRightCorner<3, 3>() = -c;
    Eigen::Matrix<double, 6, 6> H_pair;
    H_pair << H_bb, H_ab.transpose(), H_ab, H_aa;
    equations.H += A.transpose() * H_pair * A;
    const double feigned = 2.0 * noise.pixel_sigma * noise.pixel_sigma * sums.parallax_noise;
    const double measured = sums.parallax > feigned ? 1.0 - feigned / sums.parallax : 0.0;
    const double share = shares.empty() ? measured : shares[k];
    equations.shares[k] = share;
    H_pair.topLeftCorner<3, 3>() *= share;
    H_pair.topRightCorner<3, 3>() *= std::sqrt(share);
    H_pair.bottomLeftCorner<3, 3>() *= std::sqrt(share);
    equations.information += A.transpose() * H_pair * A;
    equations.g.head<3>() += g_b;
    equations.g.tail<3>() += Eigen::Map<const Eigen::Vector3d>(sums.g + 3) + center.cross(g_b);
  }
  const double weight = 1.0 / (noise.pixel_sigma * noise.pixel_sigma);
  equations.cost = 0.5 * weight * noise.loss.core * noise.loss.limit * loss;
  equations.H *= weight;
  equations.information *= weight;
  equations.g *= weight;
  Eigen::Matrix<double, 6, 6> H_rest = Eigen::Matrix<double, 6, 6>::Identity() * kWeakestInformation;
  equations.cost += addPriors(priors, R, &H_rest, &equations.g);
  equations.H += H_rest;
  equations.information += H_rest;
  return equations;
}

template TwoViewNormalEquations linearizeTwoView(const RayBlocks<float>&, bool, const TwoViewNoise&,
                                                 const MotionPriors&, const Eigen::Matrix3d&, const Eigen::Vector3d&,
                                                 const std::vector<double>&);
template TwoViewNormalEquations linearizeTwoView(const RayBlocks<double>&, bool, const TwoViewNoise&,
                                                 const MotionPriors&, const Eigen::Matrix3d&, const Eigen::Vector3d&,
                                                 const std::vector<double>&);

}  // namespace multicam_egomotion
