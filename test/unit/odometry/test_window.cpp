// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>

#include "multicam_egomotion/geometry/covariance.h"
#include "window_run.h"

namespace multicam_egomotion {
namespace {

Scenario moving(Scenario scenario, const Trajectory::Motion& motion) {
  scenario.trajectory = Trajectory(motion);
  return scenario;
}

void add(const Consistency& one, Consistency* sum) {
  sum->sum += one.sum;
  sum->count += one.count;
  sum->inside += one.inside;
  sum->dimension = one.dimension;
}

void expectConsistent(const Consistency& kind, const std::string& what) {
  ::testing::Test::RecordProperty(what + " NEES", std::to_string(kind.mean()));
  std::printf("%-40s NEES/dof %.2f, inside 95 %% bound %.1f %%, n = %d\n", what.c_str(), kind.mean(),
              100.0 * kind.share(), kind.count);
  EXPECT_GT(kind.count, 30) << what;
  EXPECT_GE(kind.mean(), 0.5) << what;
  EXPECT_LE(kind.mean(), 2.0) << what;
  EXPECT_GE(kind.share(), 0.85) << what;
  EXPECT_LE(kind.share(), 0.99) << what;
}

// Frame-to-frame consistency and drift over several seeds of scene and noise.
void expectConsistentRuns(const std::string& name, double seconds, double drift_share, bool scale) {
  Consistency rotation, direction, scale_consistency;
  for (std::uint64_t seed : {1, 2, 3}) {
    WindowRunOptions options;
    options.tracks.seed = seed;
    options.tracks.tracks_per_camera = 100;
    const WindowRun run = runWindow(makeScenario(name, lasting(seconds, seed)), options);
    std::printf("%s seed %d: drift %.4f m of %.1f m, rotation %.4f rad\n", name.c_str(), static_cast<int>(seed),
                run.position_error, run.path, run.rotation_error);
    EXPECT_EQ(run.failures, 0);
    EXPECT_LT(run.position_error, drift_share * run.path + 0.005) << name << " seed " << seed;
    EXPECT_LT(run.rotation_error, 0.01);
    add(run.rotation, &rotation);
    add(run.direction, &direction);
    add(run.scale, &scale_consistency);
  }
  expectConsistent(rotation, name + " rotation");
  expectConsistent(direction, name + " direction");
  if (scale) expectConsistent(scale_consistency, name + " scale");
}

TEST(Window, HandheldStereoIsConsistent) { expectConsistentRuns("handheld_stereo", 4.0, 0.01, true); }

TEST(Window, CarSurroundIsConsistent) { expectConsistentRuns("car_surround", 8.0, 0.015, false); }

TEST(Window, DroneFisheyeIsConsistent) { expectConsistentRuns("drone_fisheye", 5.0, 0.01, true); }

TEST(Window, OutliersAreFoundAndDoNoHarm) {
  WindowRunOptions options;
  options.consensus = true;
  options.tracks.outlier_share = 0.1;
  options.tracks.tracks_per_camera = 120;
  const WindowRun run = runWindow(makeScenario("handheld_stereo", lasting(3.0)), options);
  EXPECT_EQ(run.failures, 0);
  EXPECT_LT(run.position_error, 0.01 * run.path + 0.01);
  EXPECT_GT(run.outliers_found, 9 * run.outliers_missed);
  EXPECT_LE(run.rotation.mean(), 2.5);
}

TEST(Window, OneMovingCameraSeesNoScale) {
  WindowRunOptions options;
  const WindowRun run = runWindow(makeScenario("handheld_stereo", lasting(3.0, 1, 1)), options);
  int seen = 0, moving_frames = 0;
  for (const auto& [state, count] : run.moving_states) {
    moving_frames += count;
    if (state == ScaleState::kObservable || state == ScaleState::kWeak) seen += count;
  }
  EXPECT_EQ(seen, 0);
  EXPECT_GT(run.moving_states.at(ScaleState::kUnobservable), 0.9 * moving_frames);
}

TEST(Window, OneCameraSeesTheDirectionOfAStraightLine) {
  WindowRunOptions options;
  const WindowRun run = runWindow(makeScenario("straight_line", lasting(3.0, 1, 1)), options);
  EXPECT_LT(run.median_direction_error, 0.0175);
  EXPECT_EQ(run.states.count(ScaleState::kObservable), 0u);
}

TEST(Window, AStraightLineWithoutOverlapHasNoScale) {
  // The paper's degeneracy: pure translation, intra-camera correspondences.
  SimulationOptions simulation = lasting(2.4);
  simulation.image_rate_hz = 20.0;
  Scenario scenario = moving(makeScenario("car_surround", simulation), [](const TimeJet& t) {
    MotionJet m;
    m.x = t * 5.0;
    return m;
  });
  WindowRunOptions options;
  options.tracks.cross_camera = false;
  options.tracks.tracks_per_camera = 100;
  const WindowRun run = runWindow(scenario, options);
  EXPECT_EQ(run.states.count(ScaleState::kObservable), 0u);
  EXPECT_GT(run.states.at(ScaleState::kUnobservable) + run.frames / 10, run.frames / 2);
  EXPECT_LT(run.median_direction_error, 0.0175);
}

TEST(Window, StereoSeesTheScaleOfAStraightLine) {
  WindowRunOptions options;
  const WindowRun run = runWindow(makeScenario("straight_line", lasting(3.0)), options);
  EXPECT_GT(run.moving_states.at(ScaleState::kObservable), 0.95 * run.frames);
  EXPECT_LT(run.position_error, 0.01 * run.path);
}

TEST(Window, LaterFramesSayHowLongTheMotionsWere) {
  // Cameras without overlap, whose first frames do not see the scale and take it from a speed that is far off.
  TrackSimulationOptions options;
  options.tracks_per_camera = 100;
  constexpr int kFirst = 44;
  SimulatedWindow run(makeScenario("car_surround", lasting(6.5)), options, kFirst);
  bool scale_seen = false;
  double path = 0.0, as_seen = 0.0, as_known_later = 0.0;
  for (int frame = kFirst + 1; frame < run.frames(); ++frame) {
    const Eigen::Isometry3d T_true = run.motionTo(frame);
    MotionSummary motion;
    motion.T_a_b = T_true;
    motion.T_a_b.translation() *= scale_seen ? 1.0 : 0.2;
    motion.rotation_covariance = 1e-7 * Eigen::Matrix3d::Identity();
    motion.translation_covariance = 0.06 * Eigen::Matrix3d::Identity();
    motion.use_translation = !scale_seen;
    const WindowEstimate estimate = run.add(frame, motion);
    ASSERT_TRUE(estimate.ok) << frame;
    scale_seen = estimate.scale_state == ScaleState::kObservable;
    const double length = estimate.relative.T_a_b.translation().norm();
    path += T_true.translation().norm();
    as_seen += length;
    as_known_later = as_known_later * estimate.lengthening + length;
  }
  std::printf("path %.2f m, as seen %.2f m, as known later %.2f m\n", path, as_seen, as_known_later);
  EXPECT_NEAR(as_known_later, path, 0.01 * path);
  EXPECT_GT(std::abs(as_seen - path), 3.0 * std::abs(as_known_later - path));
}

TEST(Window, StandingStaysWhereItIs) {
  SimulationOptions simulation = lasting(10.0);
  Scenario scenario = moving(makeScenario("stop_and_go", simulation), [](const TimeJet&) {
    MotionJet m;
    m.x = TimeJet{1.0};
    m.z = TimeJet{1.0};
    m.yaw = TimeJet{0.3};
    return m;
  });
  WindowRunOptions options;
  options.tracks.tracks_per_camera = 120;
  options.tracks.loss_share = 0.002;  // what stands still is hardly lost
  options.speed_sigma = 0.1;
  const WindowRun run = runWindow(scenario, options);
  EXPECT_EQ(run.failures, 0);
  EXPECT_LT(run.largest_position_error, 0.003);  // at 0.3 px of white noise, ten times that of images
  EXPECT_GT(run.states.at(ScaleState::kNotApplicable), 0.9 * run.frames);
}

// A window some frames into a run, with what the next frame needs.
struct Prepared {
  Window window{WindowOptions()};
  TrackedFrame next;
  std::vector<Eigen::Isometry3d> T_body_cam;
  Eigen::Isometry3d T_true;
  MotionSummary motion;
};

Prepared prepare(int frames, const WindowRunOptions& options) {
  const Scenario scenario = makeScenario("handheld_stereo", lasting(2.0));
  const Simulator simulator(scenario);
  const SimulatedTracks tracks = simulateTracks(scenario, options.tracks);
  std::mt19937 random(5);
  Prepared prepared;
  prepared.T_body_cam = cameraPosesOf(scenario.rig);
  prepared.window.start(tracks.frames[0].stamp_ns, simulator.stateAtFrame(0).T_world_body, Matrix6d::Zero(),
                        tracks.frames[0], prepared.T_body_cam);
  for (int frame = 1; frame <= frames; ++frame) {
    prepared.T_true =
        simulator.stateAtFrame(frame - 1).T_world_body.inverse() * simulator.stateAtFrame(frame).T_world_body;
    prepared.motion = predictedMotion(prepared.T_true, options, 0.05, &random);
    prepared.next = tracks.frames[frame];
    if (frame < frames) {
      prepared.window.add(prepared.next, prepared.T_body_cam, prepared.motion, {prepared.motion.T_a_b});
    }
  }
  return prepared;
}

TEST(Window, VisionAloneDoesNotDependOnTheGyroscope) {
  // Contract 4: what goes back to the inertial state holds nothing of what came from it.
  WindowRunOptions options;
  options.tracks.tracks_per_camera = 60;
  const Prepared prepared = prepare(15, options);
  const std::vector<Eigen::Isometry3d> guesses = {prepared.motion.T_a_b};
  Window honest = prepared.window;
  const WindowEstimate one = honest.add(prepared.next, prepared.T_body_cam, prepared.motion, guesses);
  const auto angle = [](const RelativeMotion& a, const RelativeMotion& b) {
    return logSO3(a.T_a_b.linear().transpose() * b.T_a_b.linear()).norm();
  };
  for (double error : {5e-4, 1.5e-3}) {
    Window misled = prepared.window;
    MotionSummary wrong = prepared.motion;
    wrong.T_a_b.linear() = wrong.T_a_b.linear() * expSO3(error * Eigen::Vector3d(0.7, -0.5, 0.5));
    const WindowEstimate other = misled.add(prepared.next, prepared.T_body_cam, wrong, guesses);
    EXPECT_GT(angle(one.relative, other.relative), 0.2 * error);
    EXPECT_LT(angle(one.vision, other.vision), 0.1 * angle(one.relative, other.relative)) << "error " << error;
    EXPECT_LT((one.vision.covariance - other.vision.covariance).norm(), 0.1 * one.vision.covariance.norm());
  }
}

TEST(Window, TurningEverythingChangesNoMotion) {
  const Prepared prepared = prepare(15, {});
  Window plain = prepared.window, turned = prepared.window;
  const Eigen::Matrix3d R = expSO3({0.02, -0.03, 0.1});
  const Eigen::Vector3d pivot(1.0, 2.0, 3.0);
  turned.rotateAbout(pivot, R);
  const std::vector<Eigen::Isometry3d> guesses = {prepared.motion.T_a_b};
  const WindowEstimate one = plain.add(prepared.next, prepared.T_body_cam, prepared.motion, guesses);
  const WindowEstimate other = turned.add(prepared.next, prepared.T_body_cam, prepared.motion, guesses);
  ASSERT_TRUE(one.ok && other.ok);
  EXPECT_LT((one.relative.T_a_b.matrix() - other.relative.T_a_b.matrix()).norm(), 1e-6);
  EXPECT_LT((R * one.T_odom_body.linear() - other.T_odom_body.linear()).norm(), 1e-6);
  EXPECT_LT((pivot + R * (one.T_odom_body.translation() - pivot) - other.T_odom_body.translation()).norm(), 1e-6);
  EXPECT_EQ(one.inliers, other.inliers);
}

TEST(Window, IsDeterministic) {
  WindowRunOptions options;
  options.tracks.tracks_per_camera = 50;
  const Scenario scenario = makeScenario("drone_fisheye", lasting(1.5));
  const WindowRun one = runWindow(scenario, options), same = runWindow(scenario, options);
  EXPECT_EQ(one.position_error, same.position_error);
  EXPECT_EQ(one.rotation.sum, same.rotation.sum);
}

TEST(Window, FewTracksAreAFailureThatAStartMends) {
  Prepared prepared = prepare(10, {});
  TrackedFrame empty;
  empty.stamp_ns = prepared.next.stamp_ns;
  EXPECT_FALSE(prepared.window.add(empty, prepared.T_body_cam, prepared.motion, {prepared.motion.T_a_b}).ok);
  TrackedFrame strangers = prepared.next;
  for (FeatureObservation& one : strangers.observations) one.track += 1000000;
  EXPECT_FALSE(prepared.window.add(strangers, prepared.T_body_cam, prepared.motion, {prepared.motion.T_a_b}).ok);
  prepared.window.start(strangers.stamp_ns, Eigen::Isometry3d::Identity(), Matrix6d::Zero(), strangers,
                        prepared.T_body_cam);
  EXPECT_FALSE(prepared.window.empty());
  MotionSummary still = prepared.motion;
  still.T_a_b.setIdentity();
  const WindowEstimate estimate = prepared.window.add(strangers, prepared.T_body_cam, still, {still.T_a_b});
  EXPECT_TRUE(estimate.ok);
  EXPECT_LT(estimate.relative.T_a_b.translation().norm(), 1e-3);
}

TEST(Window, ComposedMotionsAddUp) {
  std::mt19937 random(3);
  WindowRunOptions options;
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = expSO3({0.1, 0.2, -0.3});
  T.translation() = Eigen::Vector3d(1.0, -2.0, 0.5);
  MotionSummary a = predictedMotion(T, options, 0.1, &random), b = predictedMotion(T, options, 0.1, &random);
  a.rotation_covariance = Eigen::Vector3d(1.0, 2.0, 3.0).asDiagonal();
  b.rotation_covariance.setZero();
  b.use_translation = true;
  const MotionSummary both = compose(a, b);
  EXPECT_LT((both.T_a_b.matrix() - (a.T_a_b * b.T_a_b).matrix()).norm(), 1e-12);
  EXPECT_TRUE(both.use_translation);
  // Exp(d) of the first step, seen after the second.
  const Eigen::Vector3d d(1e-6, -2e-6, 3e-6);
  const Eigen::Matrix3d R = a.T_a_b.linear() * expSO3(d) * b.T_a_b.linear();
  const Eigen::Vector3d seen = logSO3(both.T_a_b.linear().transpose() * R);
  EXPECT_NEAR(squaredMahalanobis(seen, both.rotation_covariance), squaredMahalanobis(d, a.rotation_covariance), 1e-15);
}

TEST(Window, PointsAreWhereTheyAre) {
  TrackSimulationOptions options;
  options.pixel_sigma = 0.1;
  SimulatedWindow run(makeScenario("handheld_stereo", lasting(1.0)), options, 0);
  std::mt19937 random(1);
  for (int frame = 1; frame < run.frames(); ++frame) {
    ASSERT_TRUE(run.add(frame, predictedMotion(run.motionTo(frame), {}, 0.05, &random)).ok);
  }
  const std::vector<Eigen::Vector3d> points = run.window().points();
  ASSERT_GT(points.size(), 50u);
  int near = 0;
  for (const Eigen::Vector3d& point : points) {
    double nearest = 1e9;
    for (const auto& [id, truth] : run.tracks().points) {
      nearest = std::min(nearest, (point - truth).norm() / truth.norm());
    }
    near += nearest < 0.1;
  }
  EXPECT_GT(near, 0.9 * points.size());
}

}  // namespace
}  // namespace multicam_egomotion
