// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "simulator/scenario_rig.h"

#include <string>

#include "simulator/scenario_motion.h"

namespace multicam_egomotion {

namespace {

/// Optical frame that looks to `yaw` (left positive), then `down` below the horizon, in a frame x forward, z up [rad].
Eigen::Matrix3d lookTowards(double yaw, double down, double roll = 0.0) {
  Eigen::Matrix3d R_forward_optical;
  R_forward_optical << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  return (Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()) * Eigen::AngleAxisd(down, Eigen::Vector3d::UnitY()) *
          Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitX()))
             .toRotationMatrix() *
         R_forward_optical;
}

Eigen::Isometry3d pose(const Eigen::Matrix3d& R, const Eigen::Vector3d& p) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = R;
  T.translation() = p;
  return T;
}

RigCamera camera(int index, const CameraModel& model, const Eigen::Isometry3d& T_body_cam) {
  const std::string name = "cam" + std::to_string(index);
  return {name, name, model, T_body_cam, 0.0};
}

CameraModel stereoModel(double shift_px) {
  return CameraModel(640, 480, 420.0 + 0.3 * shift_px, 419.0 + 0.3 * shift_px, 318.4 + shift_px, 242.7 - shift_px,
                     Distortion::kRadtan, {-0.28, 0.074, 2e-4, -1.5e-4});
}

/// Like the IMU of the EuRoC recordings.
ImuCalibration industrialImu(const Eigen::Isometry3d& T_body_imu) {
  ImuCalibration imu;
  imu.T_body_imu = T_body_imu;
  imu.gyroscope_noise_density = 1.7e-4;
  imu.gyroscope_random_walk = 2.0e-5;
  imu.accelerometer_noise_density = 2.0e-3;
  imu.accelerometer_random_walk = 1.0e-3;
  return imu;
}

}  // namespace

RigDescription stereoRig() {
  RigDescription rig;
  rig.cameras = {camera(0, stereoModel(0.0), pose(lookTowards(0.0, 0.05), {0.10, 0.06, 0.02})),
                 camera(1, stereoModel(2.5), pose(lookTowards(-0.008, 0.055, 0.004), {0.102, -0.06, 0.021}))};
  rig.imu = industrialImu(pose(Eigen::Matrix3d::Identity(), {0.03, 0.01, -0.05}));
  return rig;
}

RigDescription handheldRig() {
  RigDescription rig = stereoRig();
  const Eigen::Isometry3d T_body_forward = pose(handheldMounting().transpose(), Eigen::Vector3d::Zero());
  for (RigCamera& one : rig.cameras) one.T_body_cam = T_body_forward * one.T_body_cam;
  const Eigen::Matrix3d R_forward_imu =
      (Eigen::AngleAxisd(1.6, Eigen::Vector3d::UnitX()) * Eigen::AngleAxisd(-0.4, Eigen::Vector3d::UnitZ()))
          .toRotationMatrix();
  rig.imu.T_body_imu = T_body_forward * pose(R_forward_imu, {0.05, 0.03, -0.04});
  return rig;
}

RigDescription carRig() {
  const CameraModel radtan(640, 480, 380.0, 379.0, 321.3, 238.2, Distortion::kRadtan, {-0.28, 0.07, 1e-4, 2e-4});
  const CameraModel rational(640, 480, 381.5, 380.6, 317.8, 241.5, Distortion::kRationalPolynomial,
                             {0.42, 0.06, -1e-4, 1e-4, 0.002, 0.71, 0.16, 0.01});
  RigDescription rig;
  rig.cameras = {camera(0, radtan, pose(lookTowards(0.0, 0.05), {2.2, 0.05, 1.1})),
                 camera(1, radtan, pose(lookTowards(0.5 * M_PI, 0.12, 0.02), {1.3, 0.85, 1.0})),
                 camera(2, rational, pose(lookTowards(M_PI, 0.08), {-0.6, -0.03, 1.1})),
                 camera(3, radtan, pose(lookTowards(-0.5 * M_PI, 0.11, -0.02), {1.3, -0.85, 1.0}))};
  rig.imu = industrialImu(
      pose(Eigen::AngleAxisd(0.5 * M_PI, Eigen::Vector3d::UnitZ()).toRotationMatrix(), {0.08, -0.05, 0.10}));
  return rig;
}

RigDescription droneRig() {
  const CameraModel fisheye(640, 480, 220.0, 220.4, 321.7, 237.6, Distortion::kEquidistant,
                            {0.0034, 0.0007, -0.0021, 0.0002});
  const CameraModel other(640, 480, 221.1, 221.5, 316.9, 242.2, Distortion::kEquidistant,
                          {0.0031, 0.0011, -0.0024, 0.0003});
  RigDescription rig;
  rig.cameras = {camera(0, fisheye, pose(lookTowards(0.0, 0.2), {0.15, 0.01, 0.0})),
                 camera(1, other, pose(lookTowards(0.0, 1.4), {-0.09, -0.01, -0.07}))};
  rig.imu =
      industrialImu(pose(Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitX()).toRotationMatrix(), {-0.04, 0.02, 0.05}));
  return rig;
}

}  // namespace multicam_egomotion
