// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>
#include <rosbag/view.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <sstream>
#include <stdexcept>
#include <string>

#include "fault_run.h"
#include "simulated_bag.h"

namespace multicam_egomotion {

/// Path of a file of this process, removed at its end.
inline std::filesystem::path temporary(const std::string& name) {
  const auto folder = std::filesystem::path(testing::TempDir()) / ("fault_table_" + std::to_string(::getpid()));
  std::filesystem::create_directories(folder);
  return folder / name;
}

class TemporaryFiles : public testing::Environment {
  void TearDown() override { std::filesystem::remove_all(temporary("").parent_path()); }
};

inline void readStamps(TrueRecording* recording) {
  rosbag::Bag bag(recording->bag, rosbag::bagmode::Read);
  rosbag::View all(bag), images(bag, rosbag::TopicQuery("/cam0/image_raw"));
  recording->begin_ns = toNanoseconds(all.getBeginTime());
  for (const rosbag::MessageInstance& message : images) {
    recording->image_stamps_ns.push_back(toNanoseconds(message.instantiate<sensor_msgs::Image>()->header.stamp));
  }
}

/// A hand-held stereo camera, 320x240, 15 Hz, 5 s, in motion from the start.
inline const TrueRecording& handheldStereo() {
  static const TrueRecording recording = [] {
    SimulationOptions options;
    options.duration_s = 5.0;
    options.image_rate_hz = 15.0;
    Scenario scenario = makeScenario("handheld_stereo", options);
    scenario.rig = scaledRig(scenario.rig, 0.5);
    const auto simulator = std::make_shared<Simulator>(scenario);
    TrueRecording made;
    made.bag = temporary("simulated.bag").string();
    SimulatedBag(made.bag, *simulator);
    made.parameters.imu = scenario.imu;
    made.parameters.odometry.tracker.features_per_camera = 80;  // enough, and half the time
    made.truth = [simulator](std::int64_t stamp_ns) { return simulator->stateAt(stamp_ns).T_world_body; };
    readStamps(&made);
    made.clean = runBag(made.bag, made.parameters);
    return made;
  }();
  return recording;
}

/// Poses of a TUM file, interpolated.
inline std::function<Eigen::Isometry3d(std::int64_t)> readTruth(const std::string& path) {
  auto poses = std::make_shared<std::map<std::int64_t, Eigen::Isometry3d>>();
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    std::istringstream words(line);
    std::string stamp;
    Eigen::Matrix<double, 7, 1> v;
    if (line.empty() || line[0] == '#' || !(words >> stamp)) continue;
    for (int i = 0; i < 7; ++i) words >> v[i];
    const std::size_t point = stamp.find('.');
    const std::string fraction = (stamp.substr(point + 1) + "000000000").substr(0, 9);
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    T.translation() = v.head<3>();
    T.linear() = Eigen::Quaterniond(v[6], v[3], v[4], v[5]).normalized().toRotationMatrix();
    poses->emplace(std::stoll(stamp.substr(0, point)) * 1000000000 + std::stoll(fraction), T);
  }
  return [poses](std::int64_t stamp_ns) {
    const auto after = poses->lower_bound(stamp_ns);
    if (after == poses->begin()) return after->second;
    const auto before = std::prev(after);
    if (after == poses->end()) return before->second;
    const double share =
        static_cast<double>(stamp_ns - before->first) / static_cast<double>(after->first - before->first);
    Eigen::Isometry3d T = before->second;
    T.linear() *= expSO3(share * logSO3(before->second.linear().transpose() * after->second.linear()));
    T.translation() += share * (after->second.translation() - before->second.translation());
    return T;
  };
}

inline void copyStart(const std::string& from, const std::string& to, double seconds) {
  rosbag::Bag in(from, rosbag::bagmode::Read), out(to, rosbag::bagmode::Write);
  const ros::Time begin = rosbag::View(in).getBeginTime();
  rosbag::View start(in, begin, begin + ros::Duration(seconds));
  for (const rosbag::MessageInstance& message : start) out.write(message.getTopic(), message.getTime(), message);
}

/// The first 5 s of EuRoC MH_01, where the data are; without a bag otherwise.
inline TrueRecording convertedEuroc() {
  TrueRecording recording;
  const char* folder = std::getenv("MULTICAM_EGOMOTION_DATA");
  const auto data = std::filesystem::path(folder ? folder : "../shared/data") / "euroc_mh01_excerpt" / "mav0";
  if (!std::filesystem::exists(data / "cam0" / "data.csv")) return recording;
  const std::string stem = temporary("euroc").string();
  const std::string command =
      "PATH=/usr/bin:$PATH python3 scripts/euroc_to_bag.py '" + data.string() + "' '" + stem + ".bag' > /dev/null";
  if (std::system(command.c_str()) != 0) throw std::runtime_error("cannot convert: " + command);
  recording.bag = temporary("euroc_start.bag").string();
  copyStart(stem + ".bag", recording.bag, 5.0);
  std::filesystem::remove(stem + ".bag");
  recording.parameters.node.rig_file = stem + ".rig.yaml";
  recording.truth = readTruth(stem + ".groundtruth.tum");
  readStamps(&recording);
  recording.clean = runBag(recording.bag, recording.parameters);
  return recording;
}

inline const TrueRecording& euroc() {
  static const TrueRecording recording = convertedEuroc();
  return recording;
}

}  // namespace multicam_egomotion
