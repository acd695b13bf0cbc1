// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <yaml-cpp/yaml.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "ego_motion_run.h"
#include "multicam_egomotion/geometry/rigid_transform.h"
#include "multicam_egomotion/geometry/so3.h"

namespace multicam_egomotion {

inline std::filesystem::path dataFolder() {
  const char* folder = std::getenv("MULTICAM_EGOMOTION_DATA");
  return folder ? std::filesystem::path(folder) : std::filesystem::path("../shared/data");
}

/// Rows of numbers of a text file; separators are commas or blanks, lines with # are comments.
inline std::vector<std::vector<double>> numbersIn(const std::filesystem::path& file,
                                                  std::vector<std::string>* first_column = nullptr) {
  std::vector<std::vector<double>> rows;
  std::ifstream stream(file);
  for (std::string line; std::getline(stream, line);) {
    if (line.empty() || line[0] == '#') continue;
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream words(line);
    std::vector<double> row;
    std::string word;
    for (bool first = true; words >> word; first = false) {
      if (first && first_column) first_column->push_back(word);
      row.push_back(std::strtod(word.c_str(), nullptr));
    }
    rows.push_back(row);
  }
  return rows;
}

struct StampedPose {
  std::int64_t stamp_ns;
  Eigen::Isometry3d T;
};

/// Pose at a stamp, interpolated.
inline Eigen::Isometry3d poseAt(const std::vector<StampedPose>& poses, std::int64_t stamp_ns) {
  const auto after = std::lower_bound(poses.begin(), poses.end(), stamp_ns,
                                      [](const StampedPose& one, std::int64_t stamp) { return one.stamp_ns < stamp; });
  if (after == poses.begin()) return poses.front().T;
  if (after == poses.end()) return poses.back().T;
  const StampedPose &a = *(after - 1), &b = *after;
  const double share = static_cast<double>(stamp_ns - a.stamp_ns) / static_cast<double>(b.stamp_ns - a.stamp_ns);
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = a.T.linear() * expSO3(share * logSO3(a.T.linear().transpose() * b.T.linear()));
  T.translation() = (1.0 - share) * a.T.translation() + share * b.T.translation();
  return T;
}

inline RigCamera eurocCamera(const std::filesystem::path& folder) {
  const YAML::Node sensor = YAML::LoadFile((folder / "sensor.yaml").string());
  Eigen::Matrix4d T;
  for (int i = 0; i < 16; ++i) T(i / 4, i % 4) = sensor["T_BS"]["data"][i].as<double>();
  const auto intrinsics = sensor["intrinsics"].as<std::vector<double>>();
  const auto distortion = sensor["distortion_coefficients"].as<std::vector<double>>();
  const auto size = sensor["resolution"].as<std::vector<int>>();
  const std::string name = folder.filename().string();
  return {name, name,
          CameraModel(size[0], size[1], intrinsics[0], intrinsics[1], intrinsics[2], intrinsics[3], Distortion::kRadtan,
                      distortion),
          rigidTransform(T), 0.0};
}

/// The stereo excerpt of EuRoC MH_01; the body is the IMU.
struct EurocExcerpt {
  CameraRig rig;
  ImuCalibration imu;
  Recording recording;
  std::vector<StampedPose> truth;
};

/// Empty where the data are not there.
inline std::optional<EurocExcerpt> eurocExcerpt() {
  const std::filesystem::path folder = dataFolder() / "euroc_mh01_excerpt" / "mav0";
  if (!std::filesystem::exists(folder / "cam0" / "data.csv")) return std::nullopt;
  EurocExcerpt excerpt{CameraRig({eurocCamera(folder / "cam0"), eurocCamera(folder / "cam1")}), {}, {}, {}};
  const YAML::Node sensor = YAML::LoadFile((folder / "imu0" / "sensor.yaml").string());
  excerpt.imu.gyroscope_noise_density = sensor["gyroscope_noise_density"].as<double>();
  excerpt.imu.gyroscope_random_walk = sensor["gyroscope_random_walk"].as<double>();
  excerpt.imu.accelerometer_noise_density = sensor["accelerometer_noise_density"].as<double>();
  excerpt.imu.accelerometer_random_walk = sensor["accelerometer_random_walk"].as<double>();

  Recording& recording = excerpt.recording;
  std::vector<std::string> stamps, image_stamps, truth_stamps;
  for (const auto& row : numbersIn(folder / "imu0" / "data.csv", &stamps)) {
    ImuSample sample;
    sample.stamp_ns = std::stoll(stamps[recording.imu.size()]);
    sample.angular_velocity = {row[1], row[2], row[3]};
    sample.linear_acceleration = {row[4], row[5], row[6]};
    recording.imu.push_back(sample);
  }
  numbersIn(folder / "cam0" / "data.csv", &image_stamps);
  recording.frames = static_cast<int>(image_stamps.size());
  recording.stamp = [image_stamps](int frame) { return std::stoll(image_stamps[frame]); };
  recording.images = [folder, image_stamps](int frame) {
    std::vector<CameraImage> images;
    for (int camera : {0, 1}) {
      const auto file = folder / ("cam" + std::to_string(camera)) / "data" / (image_stamps[frame] + ".png");
      images.push_back({camera, std::stoll(image_stamps[frame]), cv::imread(file.string(), cv::IMREAD_GRAYSCALE)});
    }
    return images;
  };
  for (const auto& row : numbersIn(folder / "state_groundtruth_estimate0" / "data.csv", &truth_stamps)) {
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    T.linear() = Eigen::Quaterniond(row[4], row[5], row[6], row[7]).normalized().toRotationMatrix();
    T.translation() = Eigen::Vector3d(row[1], row[2], row[3]);
    excerpt.truth.push_back({std::stoll(truth_stamps[excerpt.truth.size()]), T});
  }
  return excerpt;
}

}  // namespace multicam_egomotion
