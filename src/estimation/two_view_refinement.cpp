// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "multicam_egomotion/estimation/two_view_refinement.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "multicam_egomotion/estimation/two_view_normal_equations.h"
#include "multicam_egomotion/geometry/so3.h"

namespace multicam_egomotion {
namespace {

using Matrix6d = Eigen::Matrix<double, 6, 6>;

constexpr double kCoreSigmas = 2.5, kLimitSigmas = 3.5;
constexpr double kExpectedWeight = 4.0;  // correspondences that the expected noise stands for
constexpr int kTruncationSteps = 8;
constexpr double kMeanDistrust = 0.125;  // of the inliers by their parallax
constexpr double kLeastSigma = 0.02;     // [px]
// A change of the noise that no longer matters; after so many iterations it stays as it is.
constexpr double kSteadySigma = 0.02;
constexpr int kAdaptiveIterations = 8;
constexpr double kSmallStep = 1e-4;  // squared length in sigmas of a step that no longer matters
constexpr double kLargestLambda = 1e6;
constexpr double kShortBaseline = 0.25;  // of the longest, below which its length is doubted

TwoViewNoise noiseOf(double sigma, const TwoViewRefinementOptions& options, double max_error_px) {
  const double limit = std::min(kLimitSigmas * sigma, max_error_px);
  return {{std::min({kCoreSigmas * sigma, options.robust_width_px, limit}), limit}, sigma};
}

// Standard deviation of the normal distribution of which `square` is the variance within ±core: a fixed point.
double sigmaOfTruncated(double square, double core, double greatest) {
  double sigma = std::sqrt(square);
  for (int i = 0; i < kTruncationSteps; ++i) {
    const double a = core / std::min(sigma, greatest);
    const double density = std::exp(-0.5 * a * a) / std::sqrt(2.0 * M_PI);
    sigma = std::sqrt(square / (1.0 - 2.0 * a * density / std::erf(a / std::sqrt(2.0))));
  }
  return std::min(sigma, greatest);
}

// Standard deviation that the inliers show: a step of a fixed point, since the core follows it.
double measuredSigma(const TwoViewNormalEquations& equations, const RobustLoss& loss, double expected,
                     double max_error_px) {
  const double freedom = std::max(0.0, equations.core_weight - 6.0);
  const double square = (kExpectedWeight * expected * expected + equations.core_squares) / (kExpectedWeight + freedom);
  return std::max(sigmaOfTruncated(square, loss.core, 0.5 * max_error_px), kLeastSigma);
}

// By segment, of the longest.
std::vector<double> relativeSquaredBaselines(const std::vector<RaySegment>& segments, const Eigen::Matrix3d& R,
                                             const Eigen::Vector3d& t) {
  std::vector<double> squares;
  for (const RaySegment& s : segments) squares.push_back((R * s.center1 + t - s.center2).squaredNorm());
  const double longest = squares.empty() ? 0.0 : *std::max_element(squares.begin(), squares.end());
  for (double& square : squares) square = longest > 0.0 ? square / longest : 1.0;
  return squares;
}

// The noise of an observation is the same whatever its weight w: with A = sum of w J J^T and B = sum of w^2 J J^T, the
// covariance is A^-1 B A^-1. A baseline that came out too short by chance would seem to tell all of the pose, so its
// length is what the long ones leave it.
Matrix6d covarianceOf(const TwoViewNormalEquations& equations, const RayBlocks<double>& rays, const TwoViewNoise& noise,
                      const MotionPriors& priors, const TwoViewEstimate& estimate) {
  RayBlocks<double> squared = rays;
  for (RayBlock<double>& block : squared.blocks) {
    for (double& weight : block.weight) weight *= weight;
  }
  const auto information = [&](const RayBlocks<double>& of, const std::vector<double>& shares) {
    return linearizeTwoView(of, false, noise, priors, estimate.R, estimate.t, shares).information;
  };
  const auto covariance = [&](const Matrix6d& A, const std::vector<double>& shares) {
    const Matrix6d inverse = A.llt().solve(Matrix6d::Identity());
    return Matrix6d(inverse * information(squared, shares) * inverse);
  };
  const std::vector<double> lengths = relativeSquaredBaselines(rays.segments, estimate.R, estimate.t);
  const auto isLong = [](double length) { return length > kShortBaseline * kShortBaseline; };
  if (std::all_of(lengths.begin(), lengths.end(), isLong)) return covariance(equations.information, equations.shares);
  std::vector<double> shares = equations.shares;
  for (std::size_t k = 0; k < shares.size(); ++k) shares[k] *= isLong(lengths[k]);
  const Matrix6d by_long = covariance(information(rays, shares), shares);
  shares = equations.shares;
  const std::vector<double> trust = baselineTrust(rays.segments, estimate.R, estimate.t, by_long);
  for (std::size_t k = 0; k < shares.size(); ++k) shares[k] *= trust[k];
  return covariance(information(rays, shares), shares);
}

}  // namespace

TwoViewEstimate refineTwoView(const RayBlocks<double>& rays, const MotionPriors& priors,
                              const TwoViewRefinementOptions& options, double max_error_px,
                              const TwoViewEstimate& start) {
  TwoViewEstimate estimate;
  estimate.R = start.R;
  estimate.t = start.t;
  TwoViewNoise noise =
      noiseOf(start.pixel_sigma > 0.0 ? start.pixel_sigma : max_error_px / kLimitSigmas, options, max_error_px);
  const auto linearize = [&](const Eigen::Matrix3d& at_R, const Eigen::Vector3d& at_t) {
    return linearizeTwoView(rays, false, noise, priors, at_R, at_t);
  };
  TwoViewNormalEquations now = linearize(start.R, start.t);
  if (!std::isfinite(now.cost)) return estimate;

  double lambda = 1e-4;
  for (int& iteration = estimate.iterations; iteration < options.max_iterations && lambda < kLargestLambda;
       ++iteration) {
    const double sigma = measuredSigma(now, noise.loss, options.pixel_sigma, max_error_px);
    const bool steady = iteration >= kAdaptiveIterations || std::abs(sigma - noise.pixel_sigma) < kSteadySigma * sigma;
    if (!steady) {
      noise = noiseOf(sigma, options, max_error_px);
      now = linearize(estimate.R, estimate.t);
    }
    const Eigen::Matrix<double, 6, 1> step = now.step(lambda);
    if (!step.allFinite()) return estimate;
    if (steady && -step.dot(now.g) < kSmallStep) break;
    const Eigen::Matrix3d trial_R = expSO3(step.tail<3>()) * estimate.R;
    const Eigen::Vector3d trial_t = estimate.t + step.head<3>();
    const TwoViewNormalEquations trial = linearize(trial_R, trial_t);
    if (!(trial.cost < now.cost)) {
      lambda *= 10.0;
      continue;
    }
    estimate.R = trial_R;
    estimate.t = trial_t;
    now = trial;
    lambda *= 0.1;
  }
  estimate.R = Eigen::Quaterniond(estimate.R).normalized().toRotationMatrix();
  estimate.covariance = covarianceOf(now, rays, noise, priors, estimate);
  estimate.pixel_sigma = noise.pixel_sigma;
  estimate.success = estimate.covariance.allFinite();
  return estimate;
}

}  // namespace multicam_egomotion
