// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
// What each fault of the data does to the odometry: detection, message, accuracy before and after.
#include <gtest/gtest.h>

#include <algorithm>

#include "fault_rows.h"
#include "fault_run.h"
#include "sound_output.h"
#include "true_recordings.h"

namespace multicam_egomotion {
namespace {

constexpr double kSettling = 0.5;   // after a fault, until the accuracy is judged [s]
constexpr double kVertical = 1.0;   // until the vertical of a new odom is found in motion; the attitude turns to it [s]
constexpr double kChecking = 30.0;  // of rotation, until axes and clocks are judged [deg]

const testing::Environment* const kTemporaryFiles = testing::AddGlobalTestEnvironment(new TemporaryFiles);

const std::vector<std::string> kFaultCounts = {"frame sets without IMU", "estimation failures", "time jumps",
                                               "rejected IMU samples",   "late images",         "rejected images",
                                               "undecodable images"};

/// When the body has turned so far in all [s since the bag's begin].
double timeOfRotation(const TrueRecording& recording, double angle_deg) {
  double angle = 0.0;
  const std::vector<std::int64_t>& stamps = recording.image_stamps_ns;
  for (std::size_t i = 1; i < stamps.size(); ++i) {
    const Eigen::Isometry3d turn = recording.truth(stamps[i - 1]).inverse() * recording.truth(stamps[i]);
    angle += 180.0 / M_PI * logSO3(turn.linear()).norm();
    if (angle >= angle_deg) return recording.since(stamps[i]);
  }
  return std::numeric_limits<double>::infinity();
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
  if (row.faults.empty()) {
    for (const Said& one : run.said) {  // the last comes after the end of the recording
      EXPECT_TRUE(&one == &run.said.back() || one.summary.find(';') == std::string::npos) << one.summary;
    }
  }
  std::string said;
  std::map<std::string, double> first;  // when a text was said
  for (const Said& one : run.said) {
    const double time_s = recording.since(one.stamp_ns);
    const bool without_result = one.stamp_ns == 0;
    if (!without_result && (time_s < row.begin_s || time_s > row.end_s + kSettling)) continue;
    said += "\n  " + one.summary;
    for (const auto& [text, within_s] : row.summaries) {
      if (one.summary.find(text) != std::string::npos) first.emplace(text, without_result ? 0.0 : time_s);
    }
  }
  const double begin_s = row.once_turned ? timeOfRotation(recording, kChecking) : row.begin_s;
  for (const auto& [text, within_s] : row.summaries) {
    ASSERT_TRUE(first.count(text) > 0) << text << " in:" << said;
    EXPECT_LE(first[text], begin_s + within_s) << text;
    std::printf("  \"%s\" after %.2f s\n", text.c_str(), first[text] - begin_s);
  }
  if (!row.once_turned) return;
  const double not_yet_s = timeOfRotation(recording, 0.8 * kChecking);
  for (const Said& one : run.said) {
    if (recording.since(one.stamp_ns) > not_yet_s) break;
    EXPECT_TRUE(one.gyroscope.find("not checkable yet") == 0) << one.gyroscope;
  }
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
  const double begin = row.end_s + (row.odom_epochs > 1 ? kVertical : kSettling);
  const double end = recording.since(recording.image_stamps_ns.back());
  const Drift clean = driftBetween(judgedPoses(recording, recording.clean, 0.0, 0.0), begin, end);
  const Drift drift = driftBetween(poses, begin, end);
  EXPECT_GE(drift.poses, 2);
  EXPECT_LE(drift.position_m, row.drift_factor * clean.position_m + row.drift_allowance_m) << clean.position_m;
  EXPECT_LE(drift.angle_deg, row.drift_factor * clean.angle_deg + row.drift_allowance_deg) << clean.angle_deg;
  // Before, during and after, where there is a before; a new odom epoch starts with a vertical yet to be found.
  const bool continued = row.begin_s > 0.0 && row.odom_epochs == 1;
  const Drift whole = driftBetween(poses, continued ? row.begin_s - 0.1 : begin, end);
  EXPECT_LE(whole.beyond_three_sigma, row.beyond_three_sigma_share * whole.poses)
      << "positions beyond 3 sigma of " << whole.poses;
  EXPECT_LE(whole.position_m, row.most_gained_m);
  if (std::isfinite(row.most_gained_m)) {
    EXPECT_EQ(driftBetween(poses, 0.0, end).beyond_three_sigma, 0);
  }
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
  std::filesystem::remove(bag);

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

std::string nameOf(const testing::TestParamInfo<FaultRow>& info) { return info.param.name; }

class SimulatedFaults : public testing::TestWithParam<FaultRow> {};
TEST_P(SimulatedFaults, Row) { expectRow(GetParam(), handheldStereo()); }
INSTANTIATE_TEST_SUITE_P(simulated, SimulatedFaults, testing::ValuesIn(simulatedRows()), nameOf);

class RecordedFaults : public testing::TestWithParam<FaultRow> {};
TEST_P(RecordedFaults, Row) {
  if (euroc().bag.empty()) GTEST_SKIP() << "euroc_mh01_excerpt is not there";
  expectRow(GetParam(), euroc());
}
INSTANTIATE_TEST_SUITE_P(recorded, RecordedFaults, testing::ValuesIn(recordedRows()), nameOf);

}  // namespace
}  // namespace multicam_egomotion
