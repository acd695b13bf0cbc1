// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "multicam_egomotion/odometry/rig_file.h"

#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <stdexcept>
#include <utility>

#include "kalibr_rig.h"
#include "yaml_reader.h"

namespace multicam_egomotion {
namespace {

const char* nameOf(Distortion distortion) {
  switch (distortion) {
    case Distortion::kRadtan:
      return "radtan";
    case Distortion::kRationalPolynomial:
      return "rational_polynomial";
    case Distortion::kEquidistant:
      return "equidistant";
    case Distortion::kNone:
      break;
  }
  return "none";
}

Distortion readDistortion(const YamlReader& camera) {
  const std::string model = camera.text("model", "pinhole");
  if (model != "pinhole" && model != "equidistant") {
    camera.at("model").fail("'" + model + "'", "pinhole or equidistant");
  }
  if (model == "equidistant" && !camera.has("distortion_model")) return Distortion::kEquidistant;
  const YamlReader name = camera.at("distortion_model");
  Distortion distortion;
  try {
    distortion = distortionFromName(name.text());
  } catch (const std::invalid_argument& error) {
    name.fail(error);
  }
  if (model == "equidistant" && distortion != Distortion::kEquidistant) {
    name.fail("'" + name.text() + "' for the model equidistant", "equidistant");
  }
  return distortion;
}

// What is less certain than that is no calibration.
constexpr double kLargestAngleDeg = 30.0, kLargestPositionM = 10.0, kLargestFocalLengthPercent = 50.0;
constexpr double kLargestPixels = 500.0, kLargestTimeOffsetS = 1.0;

double readDegrees(const YamlReader& node, const char* key, double fallback) {
  return node.has(key) ? node.numberUpTo(kLargestAngleDeg, key, 0.0) * M_PI / 180.0 : fallback;
}

double readPercent(const YamlReader& node, const char* key, double fallback) {
  return node.has(key) ? node.numberUpTo(kLargestFocalLengthPercent, key, 0.0) / 100.0 : fallback;
}

CameraSigmas readSigmas(const YamlReader& camera) {
  CameraSigmas sigmas;
  if (!camera.has("sigmas")) return sigmas;
  const YamlReader node = camera.at("sigmas");
  node.allowOnly(
      {"rotation_deg", "position_m", "focal_length_percent", "principal_point_px", "distortion_px", "time_offset_s"});
  sigmas.rotation = readDegrees(node, "rotation_deg", sigmas.rotation);
  sigmas.position = node.numberUpTo(kLargestPositionM, "position_m", sigmas.position);
  sigmas.focal_length = readPercent(node, "focal_length_percent", sigmas.focal_length);
  sigmas.principal_point_px = node.numberUpTo(kLargestPixels, "principal_point_px", sigmas.principal_point_px);
  sigmas.distortion_px = node.numberUpTo(kLargestPixels, "distortion_px", sigmas.distortion_px);
  sigmas.time_offset_s = node.numberUpTo(kLargestTimeOffsetS, "time_offset_s", sigmas.time_offset_s);
  return sigmas;
}

RigCamera readCamera(const YamlReader& node) {
  node.allowOnly({"name", "frame_id", "image_topic", "camera_info_topic", "model", "resolution", "intrinsics",
                  "distortion_model", "distortion", "T_body_cam", "time_offset_s", "sigmas"});
  const std::string name = node.at("name").text();
  const std::vector<int> resolution = node.at("resolution").integers(2);
  const std::vector<double> k = node.at("intrinsics").numbers(4);
  const Distortion distortion = readDistortion(node);
  const std::vector<double> coefficients = node.has("distortion") || distortion != Distortion::kNone
                                               ? node.at("distortion").numbers()
                                               : std::vector<double>();
  const Eigen::Isometry3d T_body_cam = node.at("T_body_cam").transform();
  try {
    return {name,
            node.text("frame_id", name),
            CameraModel(resolution[0], resolution[1], k[0], k[1], k[2], k[3], distortion, coefficients),
            T_body_cam,
            node.number("time_offset_s", 0.0),
            readSigmas(node)};
  } catch (const std::invalid_argument& error) {
    node.fail(error);
  }
}

ImuCalibration readImu(const YamlReader& node) {
  node.allowOnly({"frame_id", "topic", "T_body_imu", "rate_hz", "gyroscope_noise_density", "gyroscope_random_walk",
                  "accelerometer_noise_density", "accelerometer_random_walk", "mounting_sigma_deg"});
  ImuCalibration imu;
  imu.frame_id = node.text("frame_id", imu.frame_id);
  imu.topic = node.text("topic", imu.topic);
  imu.T_body_imu = node.at("T_body_imu").transform();
  imu.rate_hz = node.positiveNumber("rate_hz", imu.rate_hz);
  imu.gyroscope_noise_density = node.positiveNumber("gyroscope_noise_density", imu.gyroscope_noise_density);
  imu.gyroscope_random_walk = node.positiveNumber("gyroscope_random_walk", imu.gyroscope_random_walk);
  imu.accelerometer_noise_density = node.positiveNumber("accelerometer_noise_density", imu.accelerometer_noise_density);
  imu.accelerometer_random_walk = node.positiveNumber("accelerometer_random_walk", imu.accelerometer_random_walk);
  imu.mounting_sigma = readDegrees(node, "mounting_sigma_deg", imu.mounting_sigma);
  return imu;
}

RigFile readRig(const YamlReader& root) {
  root.allowOnly({"body_frame", "cameras", "imu"});
  const YamlReader list = root.at("cameras");
  if (!list.isList() || list.size() == 0) list.fail("no list of cameras", "a list of 1 to 8 cameras");
  std::vector<RigCamera> cameras;
  std::vector<std::string> image_topics, camera_info_topics;
  for (std::size_t i = 0; i < list.size(); ++i) {
    const YamlReader node = list.at(i);
    cameras.push_back(readCamera(node));
    image_topics.push_back(node.text("image_topic", ""));
    camera_info_topics.push_back(node.text("camera_info_topic", ""));
  }
  try {
    RigFile file{CameraRig(std::move(cameras)),        image_topics,    camera_info_topics,
                 root.text("body_frame", "base_link"), root.has("imu"), ImuCalibration()};
    if (file.has_imu) file.imu = readImu(root.at("imu"));
    return file;
  } catch (const std::invalid_argument& error) {
    list.fail(error);
  }
}

// Shortest text that reads back as the same number.
std::string shortest(double value) {
  char text[32];
  for (int digits = 6; digits <= 17; ++digits) {
    std::snprintf(text, sizeof(text), "%.*g", digits, value);
    if (std::strtod(text, nullptr) == value) break;
  }
  return text;
}

// Without the last digit, which converting the unit has made up.
std::string converted(double value) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.15g", value);
  return text;
}

std::string degrees(double radians) { return converted(radians * 180.0 / M_PI); }

std::string quoted(const std::string& text) {
  YAML::Emitter emitter;
  emitter << text;
  return emitter.c_str();
}

std::string listOf(const std::vector<double>& values) {
  std::string text = "[";
  for (const double value : values) text += (text.size() > 1 ? ", " : "") + shortest(value);
  return text + "]";
}

void writeTransform(std::ostream& out, const char* key, const Eigen::Isometry3d& T, const char* indent) {
  out << indent << key << ":\n";
  for (int row = 0; row < 4; ++row) {
    out << indent << "  - " << listOf({T(row, 0), T(row, 1), T(row, 2), T(row, 3)}) << "\n";
  }
}

void writeSigmas(std::ostream& out, const CameraSigmas& sigmas) {
  out << "    sigmas:  # standard deviations of this calibration"
      << "\n      rotation_deg: " << degrees(sigmas.rotation) << "\n      position_m: " << shortest(sigmas.position)
      << "\n      focal_length_percent: " << converted(100.0 * sigmas.focal_length)
      << "\n      principal_point_px: " << shortest(sigmas.principal_point_px)
      << "\n      distortion_px: " << shortest(sigmas.distortion_px) << "  # at the image's corner"
      << "\n      time_offset_s: " << shortest(sigmas.time_offset_s) << "\n";
}

}  // namespace

RigFile loadRigFile(const std::string& path, const std::string& kalibr_imu_path) {
  const YamlReader root(path);
  if (root.has("cameras")) {
    if (!kalibr_imu_path.empty()) {
      root.fail("the separate IMU file " + kalibr_imu_path, "none: the section imu of this file describes the IMU");
    }
    return readRig(root);
  }
  if (root.has("cam0")) return readKalibrRig(root, kalibr_imu_path);
  root.fail("neither of the keys 'cameras' and 'cam0'",
            "a rig of multicam_egomotion (cameras) or Kalibr's camchain-imucam.yaml (cam0)");
}

void writeRigFile(const std::string& path, const RigFile& file) {
  std::ofstream out(path);
  out << "# Rig of multicam_egomotion. Lengths in metres; T_body_cam maps camera (optical frame) coordinates to the "
         "body.\n";
  out << "body_frame: " << quoted(file.body_frame) << "\ncameras:\n";
  for (int i = 0; i < file.rig.size(); ++i) {
    const RigCamera& camera = file.rig.camera(i);
    const CameraModel& m = camera.model;
    out << "  - name: " << quoted(camera.name) << "\n    frame_id: " << quoted(camera.frame_id)
        << "\n    image_topic: " << quoted(file.image_topics.at(i))
        << "\n    camera_info_topic: " << quoted(file.camera_info_topics.at(i))
        << "\n    model: " << (m.distortion() == Distortion::kEquidistant ? "equidistant" : "pinhole")
        << "\n    resolution: [" << m.width() << ", " << m.height() << "]  # width, height [px]"
        << "\n    intrinsics: " << listOf({m.fx(), m.fy(), m.cx(), m.cy()}) << "  # fx, fy, cx, cy [px]"
        << "\n    distortion_model: " << nameOf(m.distortion()) << "\n    distortion: " << listOf(m.coefficients())
        << "\n";
    writeTransform(out, "T_body_cam", camera.T_body_cam, "    ");
    out << "    time_offset_s: " << shortest(camera.time_offset_s) << "  # t_imu = t_camera + time_offset_s\n";
    writeSigmas(out, camera.sigmas);
  }
  if (file.has_imu) {
    const ImuCalibration& imu = file.imu;
    out << "imu:\n  frame_id: " << quoted(imu.frame_id) << "\n  topic: " << quoted(imu.topic) << "\n";
    writeTransform(out, "T_body_imu", imu.T_body_imu, "  ");
    out << "  rate_hz: " << shortest(imu.rate_hz)
        << "\n  gyroscope_noise_density: " << shortest(imu.gyroscope_noise_density) << "  # [rad/s/sqrt(Hz)]"
        << "\n  gyroscope_random_walk: " << shortest(imu.gyroscope_random_walk) << "  # [rad/s^2/sqrt(Hz)]"
        << "\n  accelerometer_noise_density: " << shortest(imu.accelerometer_noise_density) << "  # [m/s^2/sqrt(Hz)]"
        << "\n  accelerometer_random_walk: " << shortest(imu.accelerometer_random_walk) << "  # [m/s^3/sqrt(Hz)]"
        << "\n  mounting_sigma_deg: " << degrees(imu.mounting_sigma) << "  # of the rotation of T_body_imu, per axis\n";
  }
  out.flush();
  if (!out) throw std::runtime_error("'" + path + "' cannot be written: " + std::strerror(errno));
}

}  // namespace multicam_egomotion
