// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "paper_experiments/two_camera_trial.h"

#include <cmath>

#include "multicam_egomotion/geometry/so3.h"
#include "paper_experiments/pose_errors.h"
#include "simulator/random.h"

namespace multicam_egomotion {
namespace {

constexpr double kFocalLength = 400.0, kCenterX = 320.0, kCenterY = 240.0;  // [px]
constexpr double kWidth = 640.0, kHeight = 480.0;                           // [px]
constexpr double kLeastDepth = 5.0, kLargestDepth = 20.0;                   // [m]
constexpr double kLargestTranslation = 3.0;                                 // [m]
constexpr double kLargestAngle = 10.0 * kDegree;

const std::vector<Eigen::Vector3d>& cameraCenters() {
  static const std::vector<Eigen::Vector3d> centers = {{0.0, 0.5, 0.0}, {0.0, -0.5, 0.0}};
  return centers;
}

Eigen::Matrix3d about(const Eigen::Vector3d& axis, double angle) {
  return Eigen::AngleAxisd(angle, axis).toRotationMatrix();
}

// Turns the body upright, its heading kept.
Eigen::Matrix3d alignment(double pitch, double roll) {
  return about(Eigen::Vector3d::UnitY(), pitch) * about(Eigen::Vector3d::UnitX(), roll);
}

// False where the camera does not see the point.
bool project(const Eigen::Vector3d& point, int camera, Eigen::Vector2d* pixel) {
  const Eigen::Vector3d p = point - cameraCenters()[camera];
  if (p.x() < 0.1) return false;
  *pixel = {kCenterX - kFocalLength * p.y() / p.x(), kCenterY - kFocalLength * p.z() / p.x()};
  return pixel->x() >= 0.0 && pixel->x() < kWidth && pixel->y() >= 0.0 && pixel->y() < kHeight;
}

Eigen::Vector3d bearing(const Eigen::Vector2d& pixel) {
  return Eigen::Vector3d(kFocalLength, kCenterX - pixel.x(), kCenterY - pixel.y()).normalized();
}

Eigen::Vector3d direction(TwoCameraMotion motion, Random* random) {
  if (motion == TwoCameraMotion::kForward) return Eigen::Vector3d::UnitX();
  if (motion == TwoCameraMotion::kSideways) return Eigen::Vector3d::UnitY();
  return random->gaussian3().normalized();
}

}  // namespace

std::string name(TwoCameraMotion motion) {
  switch (motion) {
    case TwoCameraMotion::kForward:
      return "forward";
    case TwoCameraMotion::kRandom:
      return "random";
    case TwoCameraMotion::kSideways:
      break;
  }
  return "sideways";
}

TwoCameraTrial::TwoCameraTrial(TwoCameraMotion motion, std::uint64_t seed, std::uint64_t trial) {
  Random random(seed, 4 * trial + static_cast<std::uint64_t>(motion));
  const auto angle = [&] { return random.uniform(-kLargestAngle, kLargestAngle); };
  const double yaw = angle(), pitch = angle(), roll = angle();
  R_ = about(Eigen::Vector3d::UnitZ(), yaw) * alignment(pitch, roll);
  // The body moves, at t1, along the direction; t is where its origin was, seen at t2.
  t_ = -R_ * direction(motion, &random) * random.uniform(0.0, kLargestTranslation);

  pitch_[0] = angle();
  roll_[0] = angle();
  const Eigen::Vector3d up2 = R_ * alignment(pitch_[0], roll_[0]).transpose() * Eigen::Vector3d::UnitZ();
  pitch_[1] = std::asin(-up2.x());
  roll_[1] = std::atan2(up2.y(), up2.z());
  R_v2_v1_ = alignment(pitch_[1], roll_[1]) * R_ * alignment(pitch_[0], roll_[0]).transpose();
  for (int k : {0, 1}) {
    pitch_noise_[k] = random.gaussian();
    roll_noise_[k] = random.gaussian();
  }

  int found = 0;
  while (found < static_cast<int>(observations_.size())) {
    Observation& observation = observations_[found];
    const int camera = found % 2;
    const Eigen::Vector2d seen(random.uniform(0.0, kWidth), random.uniform(0.0, kHeight));
    const double depth = random.uniform(kLeastDepth, kLargestDepth);
    const Eigen::Vector3d ray = bearing(seen);
    const Eigen::Vector3d point1 = cameraCenters()[camera] + ray * (depth / ray.x());
    const Eigen::Vector3d point2 = R_ * point1 + t_;
    Eigen::Vector2d other;
    if (!project(point1, camera, &observation.pixel[0]) || !project(point2, camera, &observation.pixel[1]) ||
        !project(point1, 1 - camera, &other) || !project(point2, 1 - camera, &other)) {
      continue;
    }
    for (Eigen::Vector2d& noise : observation.noise) {
      noise.x() = random.gaussian();
      noise.y() = random.gaussian();
    }
    ++found;
  }
}

RayCorrespondence TwoCameraTrial::rays(int index, double image_px) const {
  const Observation& observation = observations_[index];
  const int camera = index % 2;
  RayCorrespondence rays;
  rays.camera1 = rays.camera2 = camera;
  const Eigen::Vector3d& center = cameraCenters()[camera];
  rays.first = makeRay(bearing(observation.pixel[0] + image_px * observation.noise[0]), center);
  rays.second = makeRay(bearing(observation.pixel[1] + image_px * observation.noise[1]), center);
  return rays;
}

SolverProblem TwoCameraTrial::problem(const NoiseLevel& noise, AxisNoise axis_noise) const {
  SolverProblem problem;
  for (int i = 0; i < kLargestSample; ++i) problem.rays[i] = rays(i, noise.image_px);
  const auto noisy = [&](int k) {
    return alignment(pitch_[k] + noise.pitch * pitch_noise_[k], roll_[k] + noise.roll * roll_noise_[k]);
  };
  problem.priors.vertical = {noisy(0), noisy(1)};
  const Eigen::Vector3d rotation = logSO3(R_);
  problem.priors.angle = rotation.norm();
  if (axis_noise == AxisNoise::kTurned) {
    problem.priors.axis.axis = noisy(0).transpose() * alignment(pitch_[0], roll_[0]) * rotation.normalized();
  } else {
    problem.priors.axis.axis = logSO3(noisy(1).transpose() * R_v2_v1_ * noisy(0)).normalized();
  }
  return problem;
}

CorrespondenceSet TwoCameraTrial::further(const NoiseLevel& noise) const {
  std::vector<CorrespondenceSet::Entry> entries(kFurther);
  for (int i = 0; i < kFurther; ++i) {
    entries[i].rays = rays(kLargestSample + i, noise.image_px);
    entries[i].pixels_per_radian1 = entries[i].pixels_per_radian2 = kFocalLength;
  }
  return CorrespondenceSet(entries, cameraCenters(), cameraCenters());
}

}  // namespace multicam_egomotion
