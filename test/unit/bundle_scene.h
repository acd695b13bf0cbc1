// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <random>
#include <vector>

#include "multicam_egomotion/estimation/bundle_adjustment.h"
#include "multicam_egomotion/geometry/so3.h"

namespace multicam_egomotion {

/// Seeded random numbers of a test.
class Noise {
 public:
  explicit Noise(unsigned seed) : random_(seed) {}
  double gaussian(double sigma = 1.0) { return sigma * normal_(random_); }
  double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  Eigen::Vector3d vector(double sigma = 1.0) {
    const double x = gaussian(sigma), y = gaussian(sigma), z = gaussian(sigma);
    return {x, y, z};
  }
  Eigen::Matrix<double, 6, 1> pose(double position_sigma, double rotation_sigma) {
    Eigen::Matrix<double, 6, 1> d;
    d.head<3>() = vector(position_sigma);
    d.tail<3>() = vector(rotation_sigma);
    return d;
  }

 private:
  std::mt19937 random_;
  std::normal_distribution<double> normal_;
};

/// A rig of two to six poses that looks along +x at points 2 to 15 m away, from cameras of focal length 400 px.
struct BundleScene {
  BundleAdjustment bundle;  ///< at the truth
  std::vector<BundlePose> poses;
  std::vector<Eigen::Vector3d> points;
};

inline BundleObservation observe(const BundlePose& pose, int index, const Eigen::Vector3d& center,
                                 const Eigen::Vector3d& point, double sigma_px, Noise* noise) {
  constexpr double kFocalLength = 400.0;
  const Eigen::Vector3d x = pose.R.transpose() * (point - pose.p) - center;
  const Eigen::Vector3d exact = x.normalized();
  const Eigen::Vector3d u = exact.unitOrthogonal(), v = exact.cross(u);
  BundleObservation observation;
  observation.pose = index;
  observation.center = center;
  observation.bearing =
      (exact + (noise->gaussian(sigma_px) * u + noise->gaussian(sigma_px) * v) / kFocalLength).normalized();
  observation.to_pixel.row(0) = kFocalLength * observation.bearing.unitOrthogonal().transpose();
  observation.to_pixel.row(1) = observation.bearing.cross(Eigen::Vector3d(observation.to_pixel.row(0))).transpose();
  return observation;
}

/// `centers`: camera centres; each point is seen by all cameras from all poses. The noise is in the observations only.
inline BundleScene makeBundleScene(int poses, int points, const std::vector<Eigen::Vector3d>& centers, double sigma_px,
                                   unsigned seed) {
  Noise noise(seed);
  BundleScene scene;
  for (int i = 0; i < poses; ++i) {
    BundlePose pose;
    pose.R = expSO3(noise.vector(0.08));
    pose.p = Eigen::Vector3d(0.25 * i, 0.05 * i, 0.02 * i) + noise.vector(0.05);
    scene.poses.push_back(pose);
  }
  for (int l = 0; l < points; ++l) {
    const double x = noise.uniform(3.0, 15.0);
    const Eigen::Vector3d point(x, x * noise.uniform(-0.6, 0.6), x * noise.uniform(-0.5, 0.5));
    BundleLandmark landmark;
    landmark.origin = scene.poses[0].p + scene.poses[0].R * centers[0];
    const Eigen::Vector3d offset = point - landmark.origin;
    landmark.direction = offset.normalized();
    landmark.inverse_distance = 1.0 / offset.norm();
    for (int i = 0; i < poses; ++i) {
      for (const Eigen::Vector3d& center : centers) {
        landmark.observations.push_back(observe(scene.poses[i], i, center, point, sigma_px, &noise));
      }
    }
    scene.points.push_back(point);
    scene.bundle.landmarks.push_back(landmark);
  }
  scene.bundle.poses = scene.poses;
  scene.bundle.pixel_sigma = 0.5;
  return scene;
}

inline const std::vector<Eigen::Vector3d>& stereoCenters() {
  static const std::vector<Eigen::Vector3d> centers = {{0.1, 0.1, 0.0}, {0.1, -0.1, 0.02}};
  return centers;
}

/// Exact motion factors between successive poses.
inline void addMotionFactors(BundleScene* scene, double rotation_sigma, double translation_sigma) {
  for (int i = 1; i < static_cast<int>(scene->poses.size()); ++i) {
    const BundlePose &a = scene->poses[i - 1], &b = scene->poses[i];
    MotionFactor factor;
    factor.pose_a = i - 1;
    factor.pose_b = i;
    factor.R_a_b = a.R.transpose() * b.R;
    factor.p_b_a = a.R.transpose() * (b.p - a.p);
    factor.rotation_information = Eigen::Matrix3d::Identity() / (rotation_sigma * rotation_sigma);
    if (translation_sigma > 0.0) {
      factor.translation_information = Eigen::Matrix3d::Identity() / (translation_sigma * translation_sigma);
    }
    scene->bundle.factors.push_back(factor);
  }
}

inline void setPrior(BundleScene* scene, const std::vector<int>& poses, const Eigen::MatrixXd& H,
                     const Eigen::VectorXd& b) {
  PosePrior& prior = scene->bundle.prior;
  prior.poses = poses;
  for (int pose : poses) prior.linearization.push_back(scene->poses[pose]);
  prior.H = H;
  prior.b = b;
}

/// The cost that BundleAdjustment minimizes, written anew from its definition: Cauchy loss of every pixel error, motion
/// factors, priors of poses and inverse distances.
inline double costOf(const BundleAdjustment& bundle, const BundleOptions& options) {
  const double w2 = options.robust_width * options.robust_width;
  double sum = 0.0;
  for (const BundleLandmark& landmark : bundle.landmarks) {
    const double distance_error = landmark.inverse_distance / options.inverse_distance_sigma;
    sum += 0.5 * distance_error * distance_error;
    for (const BundleObservation& view : landmark.observations) {
      const BundlePose& pose = bundle.poses[view.pose];
      const Eigen::Vector3d point = landmark.origin + landmark.direction / landmark.inverse_distance;
      const Eigen::Vector3d x = pose.R.transpose() * (point - pose.p) - view.center;
      const Eigen::Vector2d error = view.to_pixel * x / view.bearing.dot(x) / bundle.pixel_sigma;
      sum += 0.5 * w2 * std::log1p(error.squaredNorm() / w2);
    }
  }
  for (const MotionFactor& factor : bundle.factors) {
    const BundlePose &a = bundle.poses[factor.pose_a], &b = bundle.poses[factor.pose_b];
    const Eigen::Vector3d r = logSO3(factor.R_a_b.transpose() * a.R.transpose() * b.R);
    const Eigen::Vector3d t = a.R.transpose() * (b.p - a.p) - factor.p_b_a;
    sum += 0.5 * r.dot(factor.rotation_information * r) + 0.5 * t.dot(factor.translation_information * t);
  }
  for (std::size_t i = 0; i < bundle.prior.poses.size(); ++i) {
    const auto difference = [&](std::size_t k) {
      return localDifference(bundle.prior.linearization[k], bundle.poses[bundle.prior.poses[k]]);
    };
    sum -= bundle.prior.b.segment<6>(6 * i).dot(difference(i));
    for (std::size_t j = 0; j < bundle.prior.poses.size(); ++j) {
      sum += 0.5 * difference(i).dot(bundle.prior.H.block<6, 6>(6 * i, 6 * j) * difference(j));
    }
  }
  return sum;
}

}  // namespace multicam_egomotion
