// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "multicam_egomotion/geometry/so3.h"
#include "multicam_egomotion/imu/imu_mounting.h"
#include "multicam_egomotion/imu/inertial_state.h"

namespace multicam_egomotion {

constexpr double kDegree = M_PI / 180;
constexpr int kRowsPerFrame = 10;  // ground truth at 200 Hz, frames at 20 Hz

struct TruePose {
  std::int64_t stamp_ns = 0;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
  Eigen::Matrix3d R_world_imu = Eigen::Matrix3d::Identity();
};

/// IMU samples and the truth of the IMU at 200 Hz.
struct InertialRecording {
  ImuCalibration calibration;
  ImuBuffer imu{100000};
  std::vector<TruePose> truth;
};

struct CsvRow {
  std::int64_t stamp_ns;
  std::vector<double> values;
};

inline std::vector<CsvRow> readCsv(const std::string& file) {
  std::ifstream in(file);
  std::vector<CsvRow> rows;
  std::string line, cell;
  std::getline(in, line);  // names
  while (std::getline(in, line)) {
    std::stringstream cells(line);
    CsvRow row;
    std::getline(cells, cell, ',');
    row.stamp_ns = std::stoll(cell);
    while (std::getline(cells, cell, ',')) {
      row.values.push_back(std::stod(cell));
    }
    rows.push_back(row);
  }
  return rows;
}

inline ImuCalibration eurocImu() {
  ImuCalibration calibration;  // as in the recordings' sensor.yaml
  calibration.gyroscope_noise_density = 1.6968e-4;
  calibration.gyroscope_random_walk = 1.9393e-5;
  calibration.accelerometer_noise_density = 2.0e-3;
  calibration.accelerometer_random_walk = 3.0e-3;
  return calibration;
}

inline std::string eurocFolder(const std::string& name) {
  const char* data = std::getenv("MULTICAM_EGOMOTION_DATA");
  return std::string(data ? data : "../shared/data") + "/euroc_imu/" + name;
}

/// Without truth where the recording is not there.
inline InertialRecording eurocRecording(const std::string& name) {
  const std::string folder = eurocFolder(name);
  InertialRecording recording;
  recording.calibration = eurocImu();
  if (!std::ifstream(folder + "/imu0/data.csv")) return recording;
  for (const CsvRow& row : readCsv(folder + "/imu0/data.csv")) {
    ImuSample sample;
    sample.stamp_ns = row.stamp_ns;
    sample.angular_velocity << row.values[0], row.values[1], row.values[2];
    sample.linear_acceleration << row.values[3], row.values[4], row.values[5];
    recording.imu.add(sample);
  }
  for (const CsvRow& row : readCsv(folder + "/state_groundtruth_estimate0/data.csv")) {
    const std::vector<double>& v = row.values;
    TruePose pose;
    pose.stamp_ns = row.stamp_ns;
    pose.position << v[0], v[1], v[2];
    pose.R_world_imu = Eigen::Quaterniond(v[3], v[4], v[5], v[6]).normalized().toRotationMatrix();
    recording.truth.push_back(pose);
  }
  // Velocity from positions 20 ms to either side: one source for all recordings.
  const int reach = 4, count = static_cast<int>(recording.truth.size());
  for (int i = 0; i < count; ++i) {
    const TruePose& before = recording.truth[std::max(0, i - reach)];
    const TruePose& after = recording.truth[std::min(count - 1, i + reach)];
    recording.truth[i].velocity =
        (after.position - before.position) / (1e-9 * static_cast<double>(after.stamp_ns - before.stamp_ns));
  }
  return recording;
}

inline Eigen::Vector2d tiltError(const InertialState& state, const TruePose& truth) {
  const Eigen::Vector3d up = state.attitude() * truth.R_world_imu.row(2).transpose();
  return shortestArc(up, Eigen::Vector3d::UnitZ()).head<2>();
}

/// The filter from one start on, with vision replaced by noisy ground truth.
class InertialReplay {
 public:
  InertialReplay(const InertialRecording& recording, double start_s, int seed)
      : recording_(recording), state_(recording.calibration), row_(std::lround(start_s * 200)), generator_(seed) {
    std::vector<ImuSample> samples;
    const std::int64_t stamp = truth().stamp_ns;
    recording.imu.samplesBetween(stamp - 500000000, stamp, &samples);
    initialized_ = state_.initialize(samples);
  }

  bool initialized() const { return initialized_; }
  const InertialState& state() const { return state_; }
  const TruePose& truth() const { return recording_.truth[row_]; }

  /// Goes to the next frame; false at the end.
  bool nextFrame(bool vision = true) {
    if (row_ + kRowsPerFrame >= static_cast<int>(recording_.truth.size())) {
      return false;
    }
    const TruePose& before = truth();
    row_ += kRowsPerFrame;
    state_.propagateTo(truth().stamp_ns, recording_.imu);
    if (!vision) return true;
    const double rotation_sigma = 0.05 * kDegree, velocity_sigma = 0.05;
    const Eigen::Matrix3d R_1_2 = before.R_world_imu.transpose() * truth().R_world_imu * expSO3(noise(rotation_sigma));
    const Eigen::Vector3d velocity = truth().R_world_imu.transpose() * truth().velocity + noise(velocity_sigma);
    state_.correctRelativeRotation(R_1_2, rotation_sigma * rotation_sigma * Eigen::Matrix3d::Identity());
    state_.correctVelocity(velocity, velocity_sigma * velocity_sigma * Eigen::Matrix3d::Identity());
    state_.markFrame();
    return true;
  }

 private:
  Eigen::Vector3d noise(double sigma) {
    const double x = normal_(generator_), y = normal_(generator_), z = normal_(generator_);
    return sigma * Eigen::Vector3d(x, y, z);
  }

  const InertialRecording& recording_;
  InertialState state_;
  int row_;
  std::mt19937 generator_;
  std::normal_distribution<double> normal_;
  bool initialized_ = false;
};

}  // namespace multicam_egomotion
