// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "multicam_egomotion/estimation/inlier_weights.h"
#include "multicam_egomotion/estimation/minimal_solvers.h"
#include "multicam_egomotion/estimation/robust_estimator.h"
#include "multicam_egomotion/geometry/covariance.h"
#include "multicam_egomotion/geometry/so3.h"
#include "solver_samples.h"

namespace multicam_egomotion {

/// What the robust estimator is tried on: the paper's synthetic set-up (section V-A) with outliers. Two cameras
/// (640x480, f = 400 px) 1 m apart that look along body x; points 4 to 20 m away, seen by both cameras at both times;
/// rotation within ±10 degrees about each axis, 0.3 to 3 m of translation.
struct TrialSetup {
  Motion motion = Motion::kRandom;
  bool cross_camera = false;  ///< half of the correspondences are
  double outliers = 0.3;      ///< share with a random second pixel
  int correspondences = 500;
  double noise_px = 0.5;
  double max_rotation_deg = 10.0;
};

struct RobustTrial {
  Eigen::Matrix3d R;
  Eigen::Vector3d t;
  VerticalPrior vertical;
  AxisPrior axis;
  std::vector<Eigen::Vector3d> centers;
  std::vector<CorrespondenceSet::Entry> entries, true_inliers;
  std::vector<char> outlier;  ///< by entry

  CorrespondenceSet set() const { return {entries, centers, centers}; }
  CorrespondenceSet inlierSet() const { return {true_inliers, centers, centers}; }
};

inline RobustTrial makeRobustTrial(const TrialSetup& setup, unsigned seed) {
  constexpr double kFocalLength = 400.0, kWidth = 640.0, kHeight = 480.0;
  SampleSimulator random(seed);
  std::mt19937 noise_source(seed + 1000003);
  std::normal_distribution<double> normal;
  RobustTrial trial;
  trial.centers = {{0.0, 0.5, 0.0}, {0.0, -0.5, 0.0}};
  const double angle = setup.max_rotation_deg * M_PI / 180.0;
  const Eigen::Vector3d angles = random.uniformVector(angle);
  trial.R = (Eigen::AngleAxisd(angles.z(), Eigen::Vector3d::UnitZ()) *
             Eigen::AngleAxisd(angles.y(), Eigen::Vector3d::UnitY()) *
             Eigen::AngleAxisd(angles.x(), Eigen::Vector3d::UnitX()))
                .toRotationMatrix();
  const double distance = random.uniform(0.3, 3.0);
  trial.t = distance * (setup.motion == Motion::kForward    ? Eigen::Vector3d(-Eigen::Vector3d::UnitX())
                        : setup.motion == Motion::kSideways ? Eigen::Vector3d(Eigen::Vector3d::UnitY())
                                                            : random.direction());
  const Eigen::Vector3d up = Eigen::Vector3d(random.uniform(-0.2, 0.2), random.uniform(-0.2, 0.2), 1.0).normalized();
  trial.vertical = verticalPriorFromUp(up, trial.R * up);
  trial.axis = {logSO3(trial.R)};

  // Bearing of a pixel, from the image centre [px], and the mean image scale there.
  const auto bearing = [&](const Eigen::Vector2d& pixel) {
    return Eigen::Vector3d(1.0, -pixel.x() / kFocalLength, -pixel.y() / kFocalLength).normalized();
  };
  const auto scale = [&](const Eigen::Vector3d& direction) {
    const double c = direction.x();
    return kFocalLength / c * std::sqrt(0.5 * (1.0 + 1.0 / (c * c)));
  };
  const auto project = [&](const Eigen::Vector3d& point, int camera, Eigen::Vector2d* pixel) {
    const Eigen::Vector3d x = point - trial.centers[camera];
    *pixel = -kFocalLength * Eigen::Vector2d(x.y(), x.z()) / x.x();
    return x.x() > 0.5 && std::abs(pixel->x()) < 0.5 * kWidth && std::abs(pixel->y()) < 0.5 * kHeight;
  };
  const auto uniformPixel = [&] {
    return Eigen::Vector2d(random.uniform(-0.5, 0.5) * kWidth, random.uniform(-0.5, 0.5) * kHeight);
  };
  const auto disturbed = [&](const Eigen::Vector2d& pixel) {
    return Eigen::Vector2d(pixel.x() + setup.noise_px * normal(noise_source),
                           pixel.y() + setup.noise_px * normal(noise_source));
  };
  int made = 0;
  while (made < setup.correspondences) {
    const Eigen::Vector3d direction = bearing(uniformPixel());
    const Eigen::Vector3d point = random.uniform(4.0, 20.0) / direction.x() * direction;
    const Eigen::Vector3d moved = trial.R * point + trial.t;
    Eigen::Vector2d first[2], second[2];
    if (!project(point, 0, &first[0]) || !project(point, 1, &first[1]) || !project(moved, 0, &second[0]) ||
        !project(moved, 1, &second[1]))
      continue;
    CorrespondenceSet::Entry entry;
    entry.rays.camera1 = made % 2;
    entry.rays.camera2 = setup.cross_camera && made % 4 < 2 ? 1 - entry.rays.camera1 : entry.rays.camera1;
    const bool outlier = random.uniform(0.0, 1.0) < setup.outliers;
    const Eigen::Vector3d d1 = bearing(disturbed(first[entry.rays.camera1]));
    const Eigen::Vector3d d2 = bearing(disturbed(outlier ? uniformPixel() : second[entry.rays.camera2]));
    entry.rays.first = makeRay(d1, trial.centers[entry.rays.camera1]);
    entry.rays.second = makeRay(d2, trial.centers[entry.rays.camera2]);
    entry.pixels_per_radian1 = scale(d1);
    entry.pixels_per_radian2 = scale(d2);
    trial.entries.push_back(entry);
    trial.outlier.push_back(outlier);
    if (!outlier) trial.true_inliers.push_back(entry);
    ++made;
  }
  return trial;
}

/// Errors of an estimate: rotation and direction [rad], scale as a share.
struct PoseErrors {
  double rotation, direction, scale;
  bool failed() const { return rotation > M_PI / 180.0 || direction > M_PI / 18.0; }
};

inline PoseErrors poseErrors(const Eigen::Matrix3d& R, const Eigen::Vector3d& t, const RobustTrial& trial) {
  return {rotationError(R, trial.R), directionError(t, trial.t), std::abs(t.norm() / trial.t.norm() - 1.0)};
}

/// Squared error of an estimate in its own sigmas; six unknowns.
inline double normalizedSquare(const Eigen::Matrix3d& R, const Eigen::Vector3d& t,
                               const Eigen::Matrix<double, 6, 6>& covariance, const RobustTrial& trial) {
  Eigen::Matrix<double, 6, 1> d;
  d << trial.t - t, logSO3(trial.R * R.transpose());
  return squaredMahalanobis(d, covariance);
}

/// The same refinement started at the truth on the true inliers.
inline TwoViewEstimate oracleEstimate(const RobustTrial& trial, const MotionPriors& priors,
                                      const RobustEstimatorOptions& options) {
  TwoViewEstimate truth;
  truth.R = trial.R;
  truth.t = trial.t;
  const CorrespondenceSet set = trial.inlierSet();
  CorrespondenceSet::Residuals residuals;
  std::vector<double> weights;
  set.evaluate(trial.R, trial.t, options.max_epipolar_error_px, &residuals);
  weighInliers(residuals, options.refinement.pixel_sigma, options.max_epipolar_error_px, &weights);
  return refineTwoView(set.weightedBlocks(weights), priors, options.refinement, options.max_epipolar_error_px, truth);
}

/// Value below which a share of the values lies.
inline double quantile(std::vector<double> values, double share) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * (values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// Errors of the robust estimator over those of the oracle.
struct OracleComparison {
  std::vector<double> rotation, direction, scale;
  std::vector<double> normalized;  ///< squared errors in sigmas, where scale is observable
  std::vector<double> oracle_rotation, oracle_direction, oracle_scale;
  int failures = 0;  ///< those that the oracle does not have

  void add(const RobustEstimate& found, const RobustTrial& trial, const TwoViewEstimate& oracle) {
    const PoseErrors ours = poseErrors(found.R, found.t, trial), best = poseErrors(oracle.R, oracle.t, trial);
    rotation.push_back(ours.rotation);
    direction.push_back(ours.direction);
    scale.push_back(ours.scale);
    // A covariance of t in metres means nothing where its length is not known.
    if (found.scale.sigma < 0.5) normalized.push_back(normalizedSquare(found.R, found.t, found.covariance, trial));
    oracle_rotation.push_back(best.rotation);
    oracle_direction.push_back(best.direction);
    oracle_scale.push_back(best.scale);
    failures += !found.success || (ours.failed() && !best.failed());
  }
  /// The largest ratio of rotation, direction and scale errors at a quantile.
  double ratio(double share) const {
    return std::max({quantile(rotation, share) / quantile(oracle_rotation, share),
                     quantile(direction, share) / quantile(oracle_direction, share),
                     quantile(scale, share) / quantile(oracle_scale, share)});
  }
  /// Mean squared error in sigmas over the number of unknowns.
  double nees() const {
    double sum = 0.0;
    for (double one : normalized) sum += one / 6.0;
    return sum / normalized.size();
  }
};

}  // namespace multicam_egomotion
