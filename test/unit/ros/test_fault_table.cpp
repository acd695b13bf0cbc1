// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
// What each fault of the data does to the odometry: detection, message, accuracy before and after.
#include <gtest/gtest.h>
#include <rosbag/view.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <sstream>
#include <stdexcept>

#include "fault_run.h"
#include "simulated_bag.h"
#include "sound_output.h"

namespace multicam_egomotion {
namespace {

namespace fs = std::filesystem;

constexpr double kSettling = 0.5;  // after a fault, until the accuracy is judged [s]

const std::vector<std::string> kFaultCounts = {"frame sets without IMU", "estimation failures", "time jumps",
                                               "rejected IMU samples",   "late images",         "rejected images",
                                               "undecodable images"};

/// Bags of this process, removed at its end.
fs::path temporary(const std::string& name) {
  const fs::path folder = fs::path(testing::TempDir()) / ("fault_table_" + std::to_string(::getpid()));
  fs::create_directories(folder);
  return folder / name;
}

class TemporaryBags : public testing::Environment {
  void TearDown() override { fs::remove_all(temporary("").parent_path()); }
};
const testing::Environment* const kTemporaryBags = testing::AddGlobalTestEnvironment(new TemporaryBags);

void readStamps(TrueRecording* recording) {
  rosbag::Bag bag(recording->bag, rosbag::bagmode::Read);
  rosbag::View all(bag), images(bag, rosbag::TopicQuery("/cam0/image_raw"));
  recording->begin_ns = toNanoseconds(all.getBeginTime());
  for (const rosbag::MessageInstance& message : images) {
    recording->image_stamps_ns.push_back(toNanoseconds(message.instantiate<sensor_msgs::Image>()->header.stamp));
  }
}

/// A hand-held stereo camera, 320x240, 15 Hz, 5 s, in motion from the start.
TrueRecording makeSimulated() {
  SimulationOptions options;
  options.duration_s = 5.0;
  options.image_rate_hz = 15.0;
  Scenario scenario = makeScenario("handheld_stereo", options);
  scenario.rig = scaledRig(scenario.rig, 0.5);
  const auto simulator = std::make_shared<Simulator>(scenario);
  TrueRecording recording;
  recording.bag = temporary("simulated.bag").string();
  SimulatedBag(recording.bag, *simulator);
  recording.parameters.imu = scenario.imu;
  recording.truth = [simulator](std::int64_t stamp_ns) { return simulator->stateAt(stamp_ns).T_world_body; };
  readStamps(&recording);
  recording.clean = runBag(recording.bag, recording.parameters);
  return recording;
}

/// Poses of a TUM file, interpolated.
std::function<Eigen::Isometry3d(std::int64_t)> readTruth(const std::string& path) {
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

/// EuRoC MH_01, where the data are; without a bag otherwise.
TrueRecording makeRecorded() {
  TrueRecording recording;
  const char* folder = std::getenv("MULTICAM_EGOMOTION_DATA");
  const fs::path data = fs::path(folder ? folder : "../shared/data") / "euroc_mh01_excerpt" / "mav0";
  if (!fs::exists(data / "cam0" / "data.csv")) return recording;
  const std::string stem = temporary("recorded").string();
  const std::string command =
      "PATH=/usr/bin:$PATH python3 scripts/euroc_to_bag.py '" + data.string() + "' '" + stem + ".bag' > /dev/null";
  if (std::system(command.c_str()) != 0) throw std::runtime_error("cannot convert: " + command);
  recording.bag = stem + ".bag";
  recording.parameters.node.rig_file = stem + ".rig.yaml";
  recording.truth = readTruth(stem + ".groundtruth.tum");
  readStamps(&recording);
  recording.clean = runBag(recording.bag, recording.parameters);
  return recording;
}

const TrueRecording& simulated() {
  static const TrueRecording recording = makeSimulated();
  return recording;
}

const TrueRecording& recorded() {
  static const TrueRecording recording = makeRecorded();
  return recording;
}

void expectDiagnostics(const FaultRow& row, const TrueRecording& recording, const FaultRun& run) {
  const auto value = [&](const std::string& key) {
    const auto found = run.diagnostics.find(key);
    return found == run.diagnostics.end() ? -1.0 : std::strtod(found->second.c_str(), nullptr);
  };
  for (const auto& [key, at_least] : row.least) EXPECT_GE(value(key), at_least) << key;
  for (const std::string& key : kFaultCounts) {
    const bool named =
        std::any_of(row.least.begin(), row.least.end(), [&](const auto& one) { return one.first == key; });
    EXPECT_TRUE(named || value(key) == 0.0) << key << " is " << value(key) << ", expected 0";
  }
  std::string said;
  for (const auto& [stamp_ns, summary] : run.summaries) {
    const double time_s = recording.since(stamp_ns);
    const bool without_result = stamp_ns == 0;
    if (without_result || (time_s >= row.begin_s && time_s <= row.end_s + kSettling)) said += "\n  " + summary;
  }
  for (const std::string& text : row.summaries)
    EXPECT_TRUE(said.find(text) != std::string::npos) << text << " in:" << said;
}

void expectSameBefore(const FaultRow& row, const TrueRecording& recording, const FaultRun& run) {
  std::size_t i = 0;
  for (const EgoMotionResult& clean : recording.clean.results) {
    if (recording.since(clean.stamp_ns) > row.begin_s - 0.1) break;
    ASSERT_LT(i, run.results.size());
    const EgoMotionResult& found = run.results[i++];
    ASSERT_EQ(found.stamp_ns, clean.stamp_ns);
    EXPECT_EQ(found.T_odom_body.pose.matrix(), clean.T_odom_body.pose.matrix()) << found.stamp_ns;
  }
}

void expectSameAccuracyAfter(const FaultRow& row, const TrueRecording& recording,
                             const std::vector<JudgedPose>& poses) {
  const double begin = row.end_s + kSettling, end = recording.since(recording.image_stamps_ns.back());
  const Drift clean = driftBetween(judgedPoses(recording, recording.clean, 0.0, 0.0), begin, end);
  const Drift drift = driftBetween(poses, begin, end);
  EXPECT_GE(drift.poses, 2);
  EXPECT_LE(drift.position_m, row.drift_factor * clean.position_m + row.drift_allowance_m) << clean.position_m;
  EXPECT_LE(drift.angle_deg, row.drift_factor * clean.angle_deg + row.drift_allowance_deg) << clean.angle_deg;
  // Before, during and after, where there is a before; a new odom epoch starts with a vertical yet to be found.
  const bool continued = row.begin_s > 0.0 && row.odom_epochs == 1;
  const Drift whole = driftBetween(poses, continued ? row.begin_s - 0.1 : begin, end);
  EXPECT_LE(whole.beyond_three_sigma, 0.05 * whole.poses) << "positions beyond 3 sigma of " << whole.poses;
  std::printf("  %d poses; after: drift %.1f mm %.2f deg, without faults %.1f mm %.2f deg; all: %.1f mm %.2f deg\n",
              whole.poses, 1e3 * drift.position_m, drift.angle_deg, 1e3 * clean.position_m, clean.angle_deg,
              1e3 * whole.position_m, whole.angle_deg);
}

void expectRow(const FaultRow& row, const TrueRecording& recording) {
  Parameters parameters = recording.parameters;
  ParameterMap changed;
  for (const auto& [name, value] : row.parameters) changed[name] = value;
  ASSERT_TRUE(applyParameters(changed, &parameters).empty());
  const std::string bag = temporary("corrupted.bag").string();
  std::vector<FaultRequest> faults;
  for (const std::string& fault : row.faults) faults.push_back(parseFault(fault));
  corruptBag(recording.bag, bag, faults, 1);
  const FaultRun run = runBag(bag, parameters);
  fs::remove(bag);

  if (!row.refusal.empty()) {
    EXPECT_TRUE(run.refusal.find(row.refusal) != std::string::npos) << run.refusal;
    return;
  }
  ASSERT_EQ(run.refusal, "");
  const std::vector<JudgedPose> poses = judgedPoses(recording, run, row.begin_s, row.stamp_shift_s);
  ASSERT_EQ(poses.empty(), row.pose_share == 0.0);
  expectSoundOutput(run.results, parameters.odometry.max_coast_s, row.stamps_jump);
  expectDiagnostics(row, recording, run);
  if (row.pose_share == 0.0) return;
  if (row.accurate) {
    expectSameBefore(row, recording, run);
    expectSameAccuracyAfter(row, recording, poses);
  }
  EXPECT_GE(shareOfPoses(recording, poses), row.pose_share);
  EXPECT_EQ(run.results.back().odom_epoch + 1, static_cast<std::uint32_t>(row.odom_epochs));
}

std::vector<FaultRow> simulatedRows() {
  return {
      FaultRow("none", {}),

      // Time
      FaultRow("time_jump_back", {"time_jump:at=2.5,by=-10"})
          .during(2.5, 2.5)
          .stampsOffBy(-10.0)
          .counts("time jumps", 1)
          .counts("odom epoch", 1)
          .epochs(2)
          .poses(0.95)
          .drifts(1.5, 0.02, 0.5),
      FaultRow("time_jump_forward", {"time_jump:at=2.5,by=0.4"}).during(2.5, 2.5).stampsOffBy(0.4).says("COASTING"),
      FaultRow("time_jump_forward_far", {"time_jump:at=2.5,by=10"})
          .during(2.5, 2.5)
          .stampsOffBy(10.0)
          .counts("time jumps", 1),
      FaultRow("time_jump_back_short", {"time_jump:at=2.5,by=-0.3"})
          .during(2.5, 2.5)
          .stampsOffBy(-0.3)
          .counts("time jumps", 1)
          .counts("odom epoch", 1)
          .epochs(2)
          .poses(0.95)
          .drifts(1.5, 0.02, 0.5),
      FaultRow("time_jump_back_continued", {"time_jump:at=2.5,by=-10"})
          .with("on_time_jump", "continue")
          .during(2.5, 2.5)
          .stampsOffBy(-10.0)
          .stampsJump()
          .counts("time jumps", 1)
          .poses(0.95)
          .drifts(1.5, 0.02, 0.5),
      FaultRow("time_gap", {"time_gap:from=2.5,to=3"}).during(2.5, 3.0).says("COASTING").poses(0.9),
      FaultRow("bag_loop", {"bag_loop:times=2"})
          .counts("time jumps", 1)
          .counts("odom epoch", 1)
          .epochs(2)
          .drifts(1.5, 0.01, 0.3),
      FaultRow("duplicate_images", {"duplicate_images:every=2"}).counts("rejected images", 50),
      FaultRow("duplicate_imu", {"duplicate_imu:every=3"}).counts("rejected IMU samples", 300),
      FaultRow("out_of_order_images", {"out_of_order_images:camera=0,every=5,delay=0.08"}).counts("late images", 10),
      FaultRow("out_of_order_imu", {"out_of_order_imu"}).counts("rejected IMU samples", 100),
      FaultRow("imu_late_within_the_wait", {"imu_late:delay=0.1"}),
      FaultRow("zero_stamps", {"zero_stamps"}).counts("rejected images", 10).counts("rejected IMU samples", 100),

      // Cameras
      FaultRow("camera_lost", {"camera_lost:camera=1,from=2.5,to=3.5"})
          .during(2.5, 3.5)
          .says("no images of cam1")
          .counts("late images", 0),
      FaultRow("first_camera_lost", {"camera_lost:camera=0,from=2.5,to=3.5"})
          .during(2.5, 3.5)
          .says("no images of cam0")
          .counts("late images", 0),
      FaultRow("all_cameras_lost", {"camera_lost:camera=-1,from=2.5,to=3.5"}).during(2.5, 3.5).says("COASTING"),
      FaultRow("image_encoding_unknown_of_all", {"image_encoding:encoding=unknown,from=2.5,to=3.5"})
          .during(2.5, 3.5)
          .counts("undecodable images", 30)
          .says("COASTING"),
      FaultRow("image_frozen", {"image_frozen:from=2.5,to=3.5"})
          .during(2.5, 3.5)
          .says("frozen")
          .counts("estimation failures", 0),
      FaultRow("image_frozen_of_one_camera", {"image_frozen:camera=1,from=2.5,to=3.5"}).during(2.5, 3.5).says("frozen"),
      FaultRow("camera_late_within_the_timeout", {"camera_late:delay=0.04,from=2.5,to=3.5"}).during(2.5, 3.5),
      FaultRow("camera_late", {"camera_late:delay=0.2,from=2.5,to=3.5"}).during(2.5, 3.5).counts("late images", 10),
      FaultRow("image_size", {"image_size:from=2.5,to=3.5"}).during(2.5, 3.5).counts("rejected images", 15),
      FaultRow("image_encoding_known", {"image_encoding:encoding=bgr8,from=2.5,to=3.5"}).during(2.5, 3.5),
      FaultRow("image_encoding_16_bits", {"image_encoding:encoding=mono16,from=2.5,to=3.5"}).during(2.5, 3.5),
      FaultRow("image_encoding_unknown", {"image_encoding:camera=1,encoding=unknown,from=2.5,to=3.5"})
          .during(2.5, 3.5)
          .counts("undecodable images", 15),
      FaultRow("image_truncated", {"image_truncated:from=2.5,to=3.5"})
          .during(2.5, 3.5)
          .counts("undecodable images", 15),
      FaultRow("image_blank", {"image_blank:from=2.5,to=3.5"})
          .during(2.5, 3.5)
          .counts("estimation failures", 14)
          .says("COASTING"),
      FaultRow("image_dark", {"image_dark:from=2.5,to=3.5"})
          .during(2.5, 3.5)
          .counts("estimation failures", 14)
          .says("COASTING"),
      FaultRow("image_saturated", {"image_saturated:from=2.5,to=3.5"})
          .during(2.5, 3.5)
          .counts("estimation failures", 14)
          .says("COASTING"),
      FaultRow("image_noise", {"image_noise:from=2.5,to=3.5"}).during(2.5, 3.5),
      FaultRow("obstruction_of_one_camera", {"obstruction:camera=0,from=2.5,to=3.5"}).during(2.5, 3.5),
      FaultRow("obstruction_of_all", {"obstruction:camera=-1,width=1,from=2.5,to=3.5"})
          .during(2.5, 3.5)
          .counts("estimation failures", 14)
          .says("COASTING"),
      FaultRow("moving_object", {"moving_object:from=2.5,to=3.5"}).during(2.5, 3.5),
      FaultRow("large_moving_object", {"moving_object:size=0.7,from=2.5,to=3.5"}).during(2.5, 3.5),
      FaultRow("exposure_steps", {"exposure_steps:from=2.5,to=3.5"}).during(2.5, 3.5).counts("estimation failures", 0),
      FaultRow("camera_info_absent", {"camera_info_absent"}).refused("no CameraInfo in the bag on 'cam1/camera_info'"),
      FaultRow("camera_info_zero", {"camera_info_zero"})
          .refused("CameraInfo of 'cam1': found K[0] = 0, expected a calibrated camera"),
      FaultRow("camera_info_mismatch_of_all", {"camera_info_mismatch:camera=-1"})
          .counts("rejected images", 152)
          .says("320x240, expected 160x120")
          .poses(0.0),
      FaultRow("shared_frame_id", {"shared_frame_id"}).refused("shared with another camera and P[3] = 0"),

      // IMU
      FaultRow("imu_gap", {"imu_gap:from=2.5,to=2.8"}).during(2.5, 2.8).counts("frame sets without IMU", 1),
      FaultRow("imu_gap_of_a_second", {"imu_gap:from=2.5,to=3.5"})
          .during(2.5, 3.5)
          .counts("frame sets without IMU", 10),
      FaultRow("imu_stops", {"imu_silent:from=2.5"})
          .during(2.5, 2.5)
          .counts("frame sets without IMU", 40)
          .drifts(1.5, 0.02, 1.0),
      FaultRow("imu_never_there", {"imu_silent:from=0"}).refused("no IMU data (without an IMU: use_imu: false)"),
      FaultRow("imu_nan", {"imu_nan:from=2.5,to=3.5"}).during(2.5, 3.5).counts("rejected IMU samples", 40),
      FaultRow("imu_nan_only", {"imu_nan:every=1,from=2.5,to=3.5"})
          .during(2.5, 3.5)
          .counts("rejected IMU samples", 200)
          .counts("frame sets without IMU", 10),
      FaultRow("imu_bias", {"imu_bias"}).counts("gyroscope bias [rad/s]", 0.05).drifts(1.5, 0.03, 2.0),
      FaultRow("imu_frozen", {"imu_frozen:from=2,to=4.5"}).during(2.0, 4.5).says("frozen?").onlyNamed(),
      FaultRow("imu_saturated", {"imu_saturated:from=2,to=4.5"}).during(2.0, 4.5).says("saturated?").onlyNamed(),
      FaultRow("imu_nan_named", {"imu_nan:from=2,to=4.5"})
          .during(2.0, 4.5)
          .counts("rejected IMU samples", 100)
          .says("not finite")
          .onlyNamed(),
      FaultRow("imu_g_units", {"imu_g_units"}).during(0.0, 3.0).says("in g?").onlyNamed(),
      FaultRow("imu_rate", {"imu_rate:rate=10"}).during(0.0, 3.0).says("expected 200 Hz").drifts(2.0, 0.01, 0.3),
      FaultRow("imu_swapped_axes", {"imu_swapped_axes"}).during(0.0, 5.0).says("x is y, y is x").onlyNamed(),
      FaultRow("gyroscope_swapped_axes", {"imu_swapped_axes:axes=yz,sensor=gyroscope"})
          .during(0.0, 5.0)
          .says("y is z, z is y")
          .onlyNamed(),
      FaultRow("clock_offset", {"clock_offset:offset=0.02"})
          .stampsOffBy(0.02)
          .during(0.0, 5.0)
          .says("clocks -20 ms apart")
          .onlyNamed(),
      FaultRow("imu_orientation_unused", {"imu_orientation"}),
      FaultRow("imu_orientation_without_covariance", {"imu_orientation"}).with("imu_orientation", "message"),
  };
}

std::vector<FaultRow> recordedRows() {
  return {
      FaultRow("all_cameras_lost", {"camera_lost:camera=-1,from=3,to=4"}).during(3.0, 4.0).says("COASTING"),
      FaultRow("time_gap", {"time_gap:from=3,to=3.5"}).during(3.0, 3.5).says("COASTING"),
      FaultRow("bag_loop", {"bag_loop:times=2"}).counts("time jumps", 1).counts("odom epoch", 1).epochs(2),
      FaultRow("image_blank", {"image_blank:from=3,to=4"})
          .during(3.0, 4.0)
          .counts("estimation failures", 19)
          .says("COASTING"),
      FaultRow("camera_late", {"camera_late:delay=0.2,from=3,to=5"}).during(3.0, 5.0).counts("late images", 30),
      FaultRow("imu_nan", {"imu_nan:from=3,to=4"}).during(3.0, 4.0).counts("rejected IMU samples", 39),
      FaultRow("imu_gap", {"imu_gap:from=3,to=3.5"}).during(3.0, 3.5).counts("frame sets without IMU", 5),
  };
}

std::string nameOf(const testing::TestParamInfo<FaultRow>& info) { return info.param.name; }

class SimulatedFaults : public testing::TestWithParam<FaultRow> {};
TEST_P(SimulatedFaults, Row) { expectRow(GetParam(), simulated()); }
INSTANTIATE_TEST_SUITE_P(simulated, SimulatedFaults, testing::ValuesIn(simulatedRows()), nameOf);

class RecordedFaults : public testing::TestWithParam<FaultRow> {};
TEST_P(RecordedFaults, Row) {
  if (recorded().bag.empty()) GTEST_SKIP() << "euroc_mh01_excerpt is not there";
  expectRow(GetParam(), recorded());
}
INSTANTIATE_TEST_SUITE_P(recorded, RecordedFaults, testing::ValuesIn(recordedRows()), nameOf);

}  // namespace
}  // namespace multicam_egomotion
