// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <memory>

#include "multicam_egomotion/geometry/covariance.h"
#include "multicam_egomotion/geometry/so3.h"
#include "scaled_rig.h"
#include "simulated_recording.h"

namespace multicam_egomotion {
namespace {

constexpr int kFrames = 36;

// At half the resolution, which renders four times as fast.
Scenario halved(Scenario scenario) {
  scenario.rig = scaledRig(scenario.rig, 0.5);
  return scenario;
}

// Renders as far as asked for and keeps the images; `simulator` must outlive it.
Recording keptRecordingOf(const Simulator& simulator) {
  Recording recording = recordingOf(simulator);
  auto rendered = std::make_shared<std::vector<FrameSet>>();
  recording.images = [rendered, &simulator](int frame) {
    while (static_cast<int>(rendered->size()) <= frame) {
      rendered->push_back(simulator.renderFrame(static_cast<int>(rendered->size())));
    }
    return (*rendered)[frame].images;
  };
  return recording;
}

// The start of handheld_stereo.
class EgoMotionTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    SimulationOptions options;
    options.duration_s = 0.05 * (kFrames - 1);
    simulator_ = new Simulator(halved(makeScenario("handheld_stereo", options)));
    recording_ = new Recording(keptRecordingOf(*simulator_));
  }
  static void TearDownTestSuite() {
    delete recording_;
    delete simulator_;
  }

  std::unique_ptr<EgoMotion> odometry(const EgoMotionOptions& options = {}) const {
    return std::make_unique<EgoMotion>(simulator_->scenario().rig, simulator_->scenario().imu, options);
  }
  static Eigen::Isometry3d truth(std::int64_t stamp_ns) { return simulator_->stateAt(stamp_ns).T_world_body; }

  // Frame-to-frame errors of results after the first ten: medians of rotation [rad] and translation [m].
  static void expectAccurate(const std::vector<EgoMotionResult>& results, double rotation, double translation) {
    std::vector<double> rotations, translations;
    for (std::size_t i = 10; i < results.size(); ++i) {
      if (!results[i].has_relative_pose) continue;
      const Eigen::Isometry3d T = truth(results[i].previous_stamp_ns).inverse() * truth(results[i].stamp_ns);
      const Eigen::Isometry3d& found = results[i].T_previous_body.pose;
      rotations.push_back(logSO3(T.linear().transpose() * found.linear()).norm());
      translations.push_back((T.translation() - found.translation()).norm());
    }
    ASSERT_GT(rotations.size(), 5u);
    EXPECT_LT(medianOf(rotations), rotation);
    EXPECT_LT(medianOf(translations), translation);
  }

  static Simulator* simulator_;
  static Recording* recording_;
};
Simulator* EgoMotionTest::simulator_ = nullptr;
Recording* EgoMotionTest::recording_ = nullptr;

void blank(std::vector<CameraImage>* images) {
  for (CameraImage& image : *images) image.grey = cv::Mat(image.grey.size(), image.grey.type(), cv::Scalar(0));
}

TEST_F(EgoMotionTest, GivesAPoseForEveryFrameFromTheSecondOn) {
  const auto odometry = this->odometry();
  RecordingPlayer player(*recording_);
  std::vector<EgoMotionResult> results = player.play(odometry.get(), 0, kFrames);
  for (const EgoMotionResult& one : odometry->finish()) results.push_back(one);
  ASSERT_EQ(static_cast<int>(results.size()), kFrames);
  for (int frame = 0; frame < kFrames; ++frame) {
    const EgoMotionResult& result = results[frame];
    EXPECT_EQ(result.stamp_ns, recording_->stamp(frame));
    EXPECT_TRUE(result.has_pose) << frame;
    EXPECT_EQ(result.has_relative_pose, frame > 0) << frame;
    EXPECT_EQ(result.previous_stamp_ns, frame > 0 ? recording_->stamp(frame - 1) : 0);
    EXPECT_EQ(result.odom_epoch, 0u);
    EXPECT_EQ(result.image_stamps_ns.size(), 2u);
    EXPECT_TRUE(result.T_odom_body.pose.matrix().allFinite());
    EXPECT_TRUE(isPositiveDefinite(result.T_odom_body.covariance) || frame == 0) << frame;
    EXPECT_TRUE(isPositiveDefinite(result.twist.covariance)) << frame;
    EXPECT_GT(result.tilt_sigma, 0.0);
    if (frame == 0) continue;
    EXPECT_TRUE(isPositiveDefinite(result.T_previous_body.covariance)) << frame;
    EXPECT_GT(result.inliers, 50) << frame;
    EXPECT_LE(result.inliers, result.tracks);
    EXPECT_FALSE(result.features.empty());
  }
  expectAccurate(results, 0.004, 0.008);
  EXPECT_EQ(results.back().scale_state, ScaleState::kObservable);
  const EgoMotionCounters counters = odometry->counters();
  EXPECT_EQ(counters.frame_sets, static_cast<std::uint64_t>(kFrames));
  EXPECT_EQ(counters.estimation_failures + counters.time_jumps + counters.rejected_imu + counters.rejected_images, 0u);
}

TEST_F(EgoMotionTest, OdomStartsAtTheBodyWithZUp) {
  const auto odometry = this->odometry();
  RecordingPlayer player(*recording_);
  const std::vector<EgoMotionResult> results = player.play(odometry.get(), 0, kFrames);
  EXPECT_LT(results.front().T_odom_body.pose.translation().norm(), 1e-9);
  // The start in motion leaves the vertical uncertain; it must say so.
  const auto tiltError = [&](const EgoMotionResult& result) {
    const Eigen::Vector3d up = truth(result.stamp_ns).linear().transpose() * Eigen::Vector3d::UnitZ();
    return std::acos(std::min(1.0, (result.T_odom_body.pose.linear() * up).z()));
  };
  EXPECT_LT(tiltError(results.front()), 4.0 * results.front().tilt_sigma);
  EXPECT_LT(tiltError(results.back()), 4.0 * results.back().tilt_sigma);
}

TEST_F(EgoMotionTest, IsBitIdenticalWhenRepeated) {
  std::vector<EgoMotionResult> runs[2];
  for (auto& run : runs) {
    const auto odometry = this->odometry();
    RecordingPlayer player(*recording_);
    run = player.play(odometry.get(), 0, 20);
  }
  ASSERT_EQ(runs[0].size(), runs[1].size());
  for (std::size_t i = 0; i < runs[0].size(); ++i) {
    const EgoMotionResult &a = runs[0][i], &b = runs[1][i];
    EXPECT_EQ(std::memcmp(a.T_odom_body.pose.data(), b.T_odom_body.pose.data(), 16 * sizeof(double)), 0) << i;
    EXPECT_EQ(std::memcmp(a.T_odom_body.covariance.data(), b.T_odom_body.covariance.data(), 36 * sizeof(double)), 0);
    EXPECT_EQ(std::memcmp(a.twist.linear.data(), b.twist.linear.data(), 3 * sizeof(double)), 0);
    EXPECT_EQ(a.scale_sigma, b.scale_sigma);
    EXPECT_EQ(a.features.size(), b.features.size());
  }
}

TEST_F(EgoMotionTest, CoastsWithoutImagesAndRecovers) {
  const auto odometry = this->odometry();
  RecordingPlayer player(*recording_);
  const auto dropped = [](int frame, std::vector<CameraImage>* images) {
    if (frame >= 14 && frame < 28) images->clear();
  };
  std::vector<EgoMotionResult> results = player.play(odometry.get(), 0, kFrames, dropped);
  std::int64_t last = 0;
  int coasting = 0;
  double last_variance = 0.0;
  for (const EgoMotionResult& result : results) {
    EXPECT_GT(result.stamp_ns, last);
    last = result.stamp_ns;
    if (result.status != EgoMotionStatus::kCoasting || result.has_relative_pose) continue;
    ++coasting;
    EXPECT_TRUE(result.has_pose);
    EXPECT_TRUE(isPositiveDefinite(result.T_odom_body.covariance));
    EXPECT_GT(result.T_odom_body.covariance.trace(), last_variance);
    last_variance = result.T_odom_body.covariance.trace();
  }
  EXPECT_GE(coasting, 5);
  const EgoMotionResult& end = results.back();
  EXPECT_EQ(end.stamp_ns, recording_->stamp(kFrames - 1));
  EXPECT_NE(end.status, EgoMotionStatus::kCoasting);
  EXPECT_NE(end.status, EgoMotionStatus::kLost);
  EXPECT_TRUE(end.has_pose && end.has_relative_pose);
}

TEST_F(EgoMotionTest, IsLostAfterTheTimeSaidAndFindsItselfAgain) {
  EgoMotionOptions options;
  options.max_coast_s = 0.2;
  const auto odometry = this->odometry(options);
  RecordingPlayer player(*recording_);
  const auto dark = [](int frame, std::vector<CameraImage>* images) {
    if (frame >= 12 && frame < 24) blank(images);
  };
  int coasting = 0, lost = 0;
  const std::vector<EgoMotionResult> results = player.play(odometry.get(), 0, kFrames, dark);
  for (const EgoMotionResult& result : results) {
    coasting += result.status == EgoMotionStatus::kCoasting;
    lost += result.status == EgoMotionStatus::kLost;
    EXPECT_EQ(result.has_pose, result.status != EgoMotionStatus::kLost) << result.stamp_ns;
  }
  EXPECT_GE(coasting, 2);
  EXPECT_GE(lost, 2);
  EXPECT_TRUE(results.back().has_relative_pose);
  EXPECT_NE(results.back().status, EgoMotionStatus::kLost);
}

TEST_F(EgoMotionTest, DarkImagesAtTheStartAreCoastingNotLost) {
  const auto odometry = this->odometry();
  RecordingPlayer player(*recording_);
  const auto dark = [](int frame, std::vector<CameraImage>* images) {
    if (frame < 6) blank(images);
  };
  const std::vector<EgoMotionResult> results = player.play(odometry.get(), 0, 20, dark);
  for (std::size_t i = 1; i < results.size(); ++i) {
    EXPECT_NE(results[i].status, EgoMotionStatus::kLost) << i;
    EXPECT_TRUE(results[i].has_pose) << i;
  }
  EXPECT_TRUE(results.back().has_relative_pose);
  EXPECT_GT(results.back().inliers, 50);
}

TEST_F(EgoMotionTest, ResetAndSetPoseStartANewEpochAtOnce) {
  const auto odometry = this->odometry();
  RecordingPlayer player(*recording_);
  player.play(odometry.get(), 0, 12);
  odometry->reset();
  std::vector<EgoMotionResult> results = player.play(odometry.get(), 12, 20);
  ASSERT_EQ(results.size(), 8u);
  EXPECT_EQ(results[0].odom_epoch, 1u);
  EXPECT_TRUE(results[0].has_pose);
  EXPECT_LT(results[0].T_odom_body.pose.translation().norm(), 1e-9);
  EXPECT_LT(results[0].T_odom_body.covariance.topLeftCorner(3, 3).trace(), 1e-6);
  EXPECT_TRUE(results[2].has_relative_pose);

  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = expSO3({0.0, 0.0, 1.0});
  pose.translation() = Eigen::Vector3d(10.0, -5.0, 2.0);
  odometry->setPose(pose);
  results = player.play(odometry.get(), 20, 28);
  ASSERT_EQ(results.size(), 8u);
  EXPECT_EQ(results[0].odom_epoch, 2u);
  EXPECT_TRUE(results[0].has_pose);
  EXPECT_LT((results[0].T_odom_body.pose.matrix() - pose.matrix()).norm(), 1e-6);
  EXPECT_LT((results[7].T_odom_body.pose.translation() - pose.translation()).norm(), 1.0);
}

TEST_F(EgoMotionTest, SurvivesNaNAndDarkness) {
  const auto odometry = this->odometry();
  Recording spoiled = *recording_;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  std::uint64_t bad = 0;
  for (std::size_t i = 120; i < spoiled.imu.size(); i += 17, ++bad) spoiled.imu[i].angular_velocity.y() = nan;
  for (std::size_t i = 125; i < spoiled.imu.size(); i += 31) spoiled.imu[i].linear_acceleration.setConstant(nan);
  RecordingPlayer player(spoiled);
  const auto dark = [](int frame, std::vector<CameraImage>* images) {
    if (frame == 12 || frame == 13) blank(images);
    if (frame == 16) images->pop_back();
    if (frame == 18) (*images)[1].grey = cv::Mat(10, 10, CV_8UC1, cv::Scalar(0));  // the wrong size
  };
  std::vector<EgoMotionResult> results = player.play(odometry.get(), 0, kFrames, dark);
  for (const EgoMotionResult& one : odometry->finish()) results.push_back(one);
  const std::vector<EgoMotionResult> frames = ofFrames(results, spoiled);
  ASSERT_EQ(static_cast<int>(frames.size()), kFrames);
  for (const EgoMotionResult& result : frames) {
    EXPECT_TRUE(result.T_odom_body.pose.matrix().allFinite());
    EXPECT_TRUE(result.T_odom_body.covariance.allFinite());
    EXPECT_TRUE(result.twist.linear.allFinite() && result.twist.covariance.allFinite());
    EXPECT_TRUE(result.has_pose);
  }
  EXPECT_TRUE(frames.back().has_relative_pose);
  EXPECT_GE(odometry->counters().rejected_imu, 1u);
  EXPECT_GE(odometry->counters().rejected_images, 1u);
  expectAccurate(std::vector<EgoMotionResult>(frames.begin() + 14, frames.end()), 0.004, 0.01);
}

TEST_F(EgoMotionTest, WorksWithoutAnImu) {
  EgoMotionOptions options;
  options.use_imu = false;
  const auto odometry = this->odometry(options);
  Recording silent = *recording_;
  silent.imu.clear();
  RecordingPlayer player(silent);
  const std::vector<EgoMotionResult> results = player.play(odometry.get(), 0, kFrames);
  ASSERT_EQ(static_cast<int>(results.size()), kFrames);
  for (int frame = 1; frame < kFrames; ++frame) {
    EXPECT_TRUE(results[frame].has_relative_pose) << frame;
    EXPECT_EQ(results[frame].status, EgoMotionStatus::kTracking) << frame;
    EXPECT_TRUE(isPositiveDefinite(results[frame].T_previous_body.covariance));
  }
  expectAccurate(results, 0.005, 0.012);
}

TEST_F(EgoMotionTest, WithoutImuDataItWaits) {
  const auto odometry = this->odometry();
  Recording silent = *recording_;
  silent.imu.clear();
  RecordingPlayer player(silent);
  for (const EgoMotionResult& result : player.play(odometry.get(), 0, 12)) {
    EXPECT_FALSE(result.has_pose);
    EXPECT_EQ(result.status, EgoMotionStatus::kInitializing);
  }
}

TEST_F(EgoMotionTest, AClockThatJumpsBackResetsOrGoesOn) {
  for (const char* behaviour : {"reset", "continue"}) {
    EgoMotionOptions options;
    options.on_time_jump = behaviour;
    const auto odometry = this->odometry(options);
    RecordingPlayer player(*recording_);
    const std::vector<EgoMotionResult> before = player.play(odometry.get(), 0, 14);
    // The same data again, 20 s earlier.
    Recording earlier = *recording_;
    const std::int64_t shift = -20000000000;
    for (ImuSample& sample : earlier.imu) sample.stamp_ns += shift;
    earlier.stamp = [shift](int frame) { return recording_->stamp(frame) + shift; };
    earlier.images = [shift](int frame) {
      std::vector<CameraImage> images = recording_->images(frame);
      for (CameraImage& image : images) image.stamp_ns += shift;
      return images;
    };
    RecordingPlayer again(earlier);
    const std::vector<EgoMotionResult> after = ofFrames(again.play(odometry.get(), 0, 14), earlier);
    EXPECT_EQ(odometry->counters().time_jumps, 1u) << behaviour;
    ASSERT_GT(after.size(), 6u) << behaviour;
    EXPECT_TRUE(after.back().has_relative_pose) << behaviour;
    const auto first = std::find_if(after.begin(), after.end(), [](const auto& one) { return one.has_pose; });
    ASSERT_NE(first, after.end());
    if (std::string(behaviour) == "reset") {
      EXPECT_EQ(first->odom_epoch, 1u);
      EXPECT_LT(first->T_odom_body.pose.translation().norm(), 1e-6);
    } else {
      const Eigen::Isometry3d last = before.back().T_odom_body.pose;
      EXPECT_EQ(first->odom_epoch, 0u);
      EXPECT_LT((first->T_odom_body.pose.translation() - last.translation()).norm(), 1e-6);
      EXPECT_LT(logSO3(first->T_odom_body.pose.linear().transpose() * last.linear()).norm(), 1e-6);
      EXPECT_GT(first->T_odom_body.covariance(0, 0), 0.99);
    }
  }
}

// Cameras without overlap, standing and then driving straight ahead: the images tell nothing of the scale, and what
// noise told of it while standing must not outlive the first motion.
TEST(EgoMotionFromRest, TakesTheScaleFromTheImu) {
  SimulationOptions options;
  options.duration_s = 2.4;
  const Simulator simulator(halved(makeScenario("car_surround", options)));
  const Recording recording = keptRecordingOf(simulator);
  EgoMotion odometry(simulator.scenario().rig, simulator.scenario().imu, EgoMotionOptions());
  RecordingPlayer player(recording);
  int moving = 0;
  for (const EgoMotionResult& one : player.play(&odometry, 0, recording.frames)) {
    if (!one.has_relative_pose) continue;
    const Eigen::Isometry3d T =
        simulator.stateAt(one.previous_stamp_ns).T_world_body.inverse() * simulator.stateAt(one.stamp_ns).T_world_body;
    const double distance = T.translation().norm();
    if (distance < 0.05) continue;
    ++moving;
    EXPECT_NEAR(one.T_previous_body.pose.translation().norm() / distance, 1.0, 0.2) << distance;
  }
  EXPECT_GT(moving, 4);
}

TEST_F(EgoMotionTest, PredictsToTheNewestImuSample) {
  const auto odometry = this->odometry();
  EXPECT_FALSE(odometry->predictToLatestImu().has_value());
  RecordingPlayer player(*recording_);
  const std::vector<EgoMotionResult> results = player.play(odometry.get(), 0, 20);
  const std::optional<EgoMotionResult> ahead = odometry->predictToLatestImu();
  ASSERT_TRUE(ahead.has_value());
  EXPECT_GT(ahead->stamp_ns, results.back().stamp_ns);
  const Eigen::Isometry3d moved = results.back().T_odom_body.pose.inverse() * ahead->T_odom_body.pose;
  const Eigen::Isometry3d T = truth(results.back().stamp_ns).inverse() * truth(ahead->stamp_ns);
  EXPECT_LT((moved.translation() - T.translation()).norm(), 0.005);
  EXPECT_LT(logSO3(moved.linear().transpose() * T.linear()).norm(), 0.003);
}

TEST_F(EgoMotionTest, WrongOptionsAreNamed) {
  const auto refused = [&](const std::function<void(EgoMotionOptions*)>& spoil, const std::string& name) {
    EgoMotionOptions options;
    spoil(&options);
    try {
      odometry(options);
      ADD_FAILURE() << name << " was accepted";
    } catch (const std::invalid_argument& error) {
      EXPECT_NE(std::string(error.what()).find(name), std::string::npos) << error.what();
    }
  };
  refused([](EgoMotionOptions* o) { o->solver = "5pt"; }, "solver");
  refused([](EgoMotionOptions* o) { o->imu_orientation = "yes"; }, "imu_orientation");
  refused([](EgoMotionOptions* o) { o->on_time_jump = "stop"; }, "on_time_jump");
  refused([](EgoMotionOptions* o) { o->max_coast_s = -1.0; }, "max_coast_s");
  refused([](EgoMotionOptions* o) { o->ransac.max_epipolar_error_px = std::nan(""); }, "max_epipolar_error_px");
  refused([](EgoMotionOptions* o) { o->window.max_keyframes = 1; }, "max_keyframes");
}

}  // namespace
}  // namespace multicam_egomotion
