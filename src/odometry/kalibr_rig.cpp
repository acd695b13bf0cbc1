// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kalibr_rig.h"

#include <stdexcept>
#include <vector>

namespace multicam_egomotion {
namespace {

Distortion readKalibrDistortion(const YamlReader& camera) {
  const YamlReader model = camera.at("camera_model");
  if (model.text() != "pinhole") {
    model.fail("the camera model '" + model.text() + "'", "pinhole (calibrate with pinhole-radtan or pinhole-equi)");
  }
  const YamlReader distortion = camera.at("distortion_model");
  const std::string name = distortion.text();
  if (name == "radtan" || name == "equidistant" || name == "none") return distortionFromName(name);
  distortion.fail("the distortion model '" + name + "'", "radtan, equidistant or none");
}

// Kalibr writes T_cam_imu for each camera; a camera without one hangs on its predecessor.
Eigen::Isometry3d readCameraFromImu(const YamlReader& camera, const std::vector<Eigen::Isometry3d>& predecessors) {
  if (!camera.has("T_cam_imu") && camera.has("T_cn_cnm1") && !predecessors.empty()) {
    return camera.at("T_cn_cnm1").transform() * predecessors.back();
  }
  return camera.at("T_cam_imu").transform();
}

// The imu.yaml given to Kalibr (keys at the root), or the one it returns (below imu0).
ImuCalibration readImu(const std::string& path) {
  const YamlReader root(path);
  const YamlReader node = root.has("imu0") ? root.at("imu0") : root;
  ImuCalibration imu;
  imu.topic = node.text("rostopic", "");
  imu.rate_hz = node.positiveNumber("update_rate", imu.rate_hz);
  imu.gyroscope_noise_density = node.at("gyroscope_noise_density").positiveNumber();
  imu.gyroscope_random_walk = node.at("gyroscope_random_walk").positiveNumber();
  imu.accelerometer_noise_density = node.at("accelerometer_noise_density").positiveNumber();
  imu.accelerometer_random_walk = node.at("accelerometer_random_walk").positiveNumber();
  if (node.has("T_i_b")) imu.T_body_imu = node.at("T_i_b").transform().inverse();
  return imu;
}

}  // namespace

RigFile readKalibrRig(const YamlReader& root, const std::string& imu_path) {
  std::vector<RigCamera> cameras;
  std::vector<std::string> topics;
  std::vector<Eigen::Isometry3d> T_cam_imu;
  for (std::string name = "cam0"; root.has(name); name = "cam" + std::to_string(cameras.size())) {
    const YamlReader camera = root.at(name);
    const Distortion distortion = readKalibrDistortion(camera);
    const std::vector<int> resolution = camera.at("resolution").integers(2);
    const std::vector<double> k = camera.at("intrinsics").numbers(4);
    const std::vector<double> coefficients = camera.has("distortion_coeffs") || distortion != Distortion::kNone
                                                 ? camera.at("distortion_coeffs").numbers()
                                                 : std::vector<double>();
    T_cam_imu.push_back(readCameraFromImu(camera, T_cam_imu));
    try {
      cameras.push_back({name, name,
                         CameraModel(resolution[0], resolution[1], k[0], k[1], k[2], k[3], distortion, coefficients),
                         T_cam_imu.back().inverse(), camera.number("timeshift_cam_imu", 0.0)});
    } catch (const std::invalid_argument& error) {
      camera.fail(error);
    }
    topics.push_back(camera.text("rostopic", ""));
  }
  const std::size_t n = cameras.size();
  try {
    RigFile file{CameraRig(std::move(cameras)), topics, std::vector<std::string>(n), "imu", true, ImuCalibration()};
    if (!imu_path.empty()) file.imu = readImu(imu_path);
    return file;
  } catch (const std::invalid_argument& error) {
    root.fail(error);
  }
}

}  // namespace multicam_egomotion
