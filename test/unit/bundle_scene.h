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
      for (std::size_t k = 0; k < centers.size(); ++k) {
        landmark.observations.push_back(observe(scene.poses[i], i, centers[k], point, sigma_px, &noise));
        landmark.observations.back().camera = static_cast<int>(k);
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
  BundlePrior& prior = scene->bundle.prior;
  prior.poses = poses;
  for (int pose : poses) prior.linearization.push_back(scene->poses[pose]);
  prior.H = H;
  prior.b = b;
}

/// What the calibration needs to know of a view. Its camera looks along +x and has images of 640 x 480 pixels; the
/// epipolar lines are those of a camera at `reference` (body axes).
inline void placeInImage(const Eigen::Vector3d& reference, BundleObservation* view) {
  view->from_center = -view->to_pixel * Eigen::Vector3d::UnitX() / view->bearing.x();
  const Eigen::Vector2d along = view->to_pixel * (reference - view->center);
  if (along.norm() < 1e-9) return;
  view->across = Eigen::Vector2d(-along.y(), along.x()).normalized();
  view->image_position = {view->from_center.dot(along.normalized()) / 320.0,
                          view->from_center.dot(view->across) / 240.0};
}

/// Three cameras: the first has a focal length alone, the second a rotation and a field, the third a rotation.
inline const std::vector<Eigen::Vector3d>& threeCenters() {
  static const std::vector<Eigen::Vector3d> centers = {{0.1, 0.1, 0.0}, {0.1, -0.1, 0.02}, {0.05, 0.0, 0.15}};
  return centers;
}

inline BundleCalibration threeCameraCalibration(bool estimate = true) {
  std::vector<CameraCorrection> cameras(3);
  cameras[1].turns = cameras[2].turns = true;
  cameras[1].has_field = true;
  return BundleCalibration(cameras, estimate);
}

/// Random values of a calibration's parameters: rotations [rad], focal lengths and, ten times as large, fields [px].
inline Eigen::VectorXd calibrationNoise(const BundleCalibration& calibration, double sigma, Noise* noise) {
  Eigen::VectorXd d(calibration.size());
  for (int i = 0; i < d.size(); ++i) d[i] = noise->gaussian(sigma);
  for (int k = 0; calibration.correction(k); ++k) {
    const CameraCorrection& camera = *calibration.correction(k);
    if (camera.has_field) d.segment<kFieldTerms>(camera.focalColumn() + 1) *= 10.0;
  }
  return d;
}

/// Error of a view [px], written anew from its definition.
inline Eigen::Vector2d errorOf(const BundleAdjustment& bundle, const BundleLandmark& landmark,
                               const BundleObservation& view) {
  const BundlePose& pose = bundle.poses[view.pose];
  const Eigen::Vector3d point = landmark.origin + landmark.direction / landmark.inverse_distance;
  Eigen::Vector3d x = pose.R.transpose() * (point - pose.p) - view.center;
  Eigen::Vector2d static_error = Eigen::Vector2d::Zero();
  if (const CameraCorrection* correction = bundle.calibration.correction(view.camera)) {
    x = correction->R.transpose() * x;
    const double s = view.image_position.x(), t = view.image_position.y();
    const double terms[] = {s * s, s * t, t * t, s * s * s, s * s * t, s * t * t, t * t * t};
    static_error = correction->focal_length * view.from_center;
    for (int i = 0; i < kFieldTerms; ++i) static_error += correction->field[i] * terms[i] * view.across;
  }
  return view.to_pixel * x / view.bearing.dot(x) + static_error + landmark.offsets[view.camera];
}

/// Turns the view's bearing until its error is nothing: as the image shows the landmark with what the bundle holds.
inline void makeExact(const BundleAdjustment& bundle, const BundleLandmark& landmark, const Eigen::Vector3d& reference,
                      BundleObservation* view) {
  for (int i = 0; i < 30; ++i) {
    placeInImage(reference, view);
    const Eigen::Vector2d error = errorOf(bundle, landmark, *view);
    view->bearing = (view->bearing + view->to_pixel.transpose() * error / (400.0 * 400.0)).normalized();
    view->to_pixel.row(0) = 400.0 * Eigen::Vector3d::UnitZ().cross(view->bearing).normalized().transpose();
    view->to_pixel.row(1) = view->bearing.cross(Eigen::Vector3d(view->to_pixel.row(0))).transpose();
  }
  placeInImage(reference, view);
}

/// Local difference of the prior's poses and calibration, written anew.
inline Eigen::VectorXd differenceFrom(const BundlePrior& prior, const BundleAdjustment& bundle) {
  std::vector<double> d;
  const auto append = [&](const auto& values) { d.insert(d.end(), values.data(), values.data() + values.size()); };
  for (std::size_t i = 0; i < prior.poses.size(); ++i) {
    append(localDifference(prior.linearization[i], bundle.poses[prior.poses[i]]));
  }
  for (int k = 0; prior.calibration.correction(k); ++k) {
    const CameraCorrection &then = *prior.calibration.correction(k), &now = *bundle.calibration.correction(k);
    if (then.turns) append(logSO3(then.R.transpose() * now.R));
    d.push_back(now.focal_length - then.focal_length);
    if (then.has_field) append(FieldVector(now.field - then.field));
  }
  return Eigen::Map<Eigen::VectorXd>(d.data(), static_cast<int>(d.size()));
}

/// The cost that BundleAdjustment minimizes, written anew from its definition: Cauchy loss of every pixel error, motion
/// factors, priors of poses, calibration, inverse distances and offsets.
inline double costOf(const BundleAdjustment& bundle, const BundleOptions& options) {
  const double w2 = options.robust_width * options.robust_width;
  double sum = 0.0;
  for (const BundleLandmark& landmark : bundle.landmarks) {
    const double distance_error = landmark.inverse_distance / options.inverse_distance_sigma;
    sum += 0.5 * distance_error * distance_error;
    for (const BundleObservation& view : landmark.observations) {
      const double error = errorOf(bundle, landmark, view).norm() / bundle.pixel_sigma;
      sum += 0.5 * w2 * std::log1p(error * error / w2);
    }
    if (bundle.offset_sigma <= 0.0) continue;
    for (const Eigen::Vector2d& offset : landmark.offsets) {
      sum += 0.5 * (offset / bundle.offset_sigma).squaredNorm();
    }
  }
  for (const MotionFactor& factor : bundle.factors) {
    const BundlePose &a = bundle.poses[factor.pose_a], &b = bundle.poses[factor.pose_b];
    const Eigen::Vector3d r = logSO3(factor.R_a_b.transpose() * a.R.transpose() * b.R);
    const Eigen::Vector3d t = a.R.transpose() * (b.p - a.p) - factor.p_b_a;
    sum += 0.5 * r.dot(factor.rotation_information * r) + 0.5 * t.dot(factor.translation_information * t);
  }
  if (bundle.prior.empty()) return sum;
  const Eigen::VectorXd d = differenceFrom(bundle.prior, bundle);
  return sum + 0.5 * d.dot(bundle.prior.H * d) - bundle.prior.b.dot(d);
}

}  // namespace multicam_egomotion
