// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "simulator/miscalibration.h"

#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "multicam_egomotion/geometry/so3.h"
#include "simulator/random.h"

namespace multicam_egomotion {

namespace {

// Streams of random numbers: the rig's own, then one a camera.
constexpr std::uint64_t kRigStream = 100, kCameraStream = 101;

// The model with its first radial coefficient k1 changed; an ideal pinhole has one afterwards.
CameraModel withRadial(const CameraModel& model, double change) {
  std::vector<double> coefficients = model.coefficients();
  if (coefficients.empty()) coefficients.push_back(0.0);
  coefficients[0] += change;
  const Distortion distortion = model.distortion() == Distortion::kNone ? Distortion::kRadtan : model.distortion();
  return {model.width(), model.height(), model.fx(), model.fy(), model.cx(), model.cy(), distortion, coefficients};
}

CameraModel wrongModel(const CameraModel& model, const CameraSigmas& sigmas, bool wrong_principal_point, double scale,
                       Random* random) {
  const double focal_length = 1.0 + scale * sigmas.focal_length * random->gaussian();
  const double across = random->gaussian(), down = random->gaussian();
  const double shift = wrong_principal_point ? scale * sigmas.principal_point_px : 0.0;
  const CameraModel radial =
      withRadial(model, scale * sigmas.distortion_px * random->gaussian() / cornerDisplacement(model));
  return {model.width(),
          model.height(),
          focal_length * model.fx(),
          focal_length * model.fy(),
          model.cx() + shift * across,
          model.cy() + shift * down,
          radial.distortion(),
          radial.coefficients()};
}

}  // namespace

double cornerDisplacement(const CameraModel& model) {
  constexpr double kChange = 1e-7;
  constexpr int kSteps = 100;
  const Eigen::Vector2d center(model.cx(), model.cy());
  const Eigen::Vector2d corner(2.0 * model.cx() < model.width() - 1 ? model.width() - 1 : 0,
                               2.0 * model.cy() < model.height() - 1 ? model.height() - 1 : 0);
  const CameraModel changed = withRadial(model, kChange);
  for (int step = kSteps; step > 0; --step) {
    const Eigen::Vector2d pixel = center + (corner - center) * step / kSteps;
    Eigen::Vector3d bearing;
    Eigen::Vector2d moved;
    if (model.unproject(pixel, &bearing) && changed.project(bearing, &moved)) {
      return (moved - pixel).dot((pixel - center).normalized()) / kChange;
    }
  }
  throw std::invalid_argument("camera model: sees nothing towards the corner of its image");
}

CalibratedRig miscalibrated(const CameraRig& rig, const ImuCalibration& imu, double scale, std::uint64_t seed) {
  if (!std::isfinite(scale) || scale < 0.0) {
    throw std::invalid_argument("scale of the calibration errors is " + std::to_string(scale) +
                                ", expected 0 (exact) or more");
  }
  if (scale == 0.0) return {rig, imu};
  Random random(seed, kRigStream);
  const double time_offset_s = scale * rig.camera(0).sigmas.time_offset_s * random.gaussian();
  std::vector<RigCamera> cameras = rig.cameras();
  for (int i = 0; i < rig.size(); ++i) {
    RigCamera& camera = cameras[i];
    Random own(seed, kCameraStream + i);
    camera.time_offset_s += time_offset_s;
    camera.model = wrongModel(camera.model, camera.sigmas, i > 0, scale, &own);
    if (i == 0) continue;
    camera.T_body_cam.linear() *= expSO3(scale * camera.sigmas.rotation * own.gaussian3());
    camera.T_body_cam.translation() += scale * camera.sigmas.position * own.gaussian3();
  }
  ImuCalibration wrong_imu = imu;
  wrong_imu.T_body_imu.linear() *= expSO3(scale * imu.mounting_sigma * random.gaussian3());
  return {CameraRig(cameras), wrong_imu};
}

}  // namespace multicam_egomotion
