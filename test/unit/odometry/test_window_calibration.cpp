// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "multicam_egomotion/geometry/covariance.h"
#include "window_run.h"

namespace multicam_egomotion {
namespace {

constexpr double kOneDegree = M_PI / 180.0;

// The rig with its last camera turned about each of its axes.
CameraRig turned(const CameraRig& rig, double angle) {
  std::vector<RigCamera> cameras = rig.cameras();
  Eigen::Isometry3d& T = cameras.back().T_body_cam;
  T.linear() = T.linear() * expSO3(Eigen::Vector3d::Constant(angle));
  return CameraRig(cameras);
}

/// A window that is given a rig whose second camera is turned, over hand-held stereo.
class TurnedStereo {
 public:
  TurnedStereo(double seconds, std::uint64_t seed, bool calibrate)
      : scenario_(makeScenario("handheld_stereo", lasting(seconds, seed))),
        given_(turned(scenario_.rig, 0.3 * kOneDegree)),
        run_(scenario_, tracksOf(seed), 0, given_, RigCalibration(given_, calibrate)),
        random_(static_cast<unsigned>(seed)) {}

  const SimulatedWindow& run() const { return run_; }

  void add(int frame) {
    MotionSummary motion = predictedMotion(run_.motionTo(frame), {}, 0.05, &random_);
    motion.use_translation = !scale_seen_;
    const WindowEstimate estimate = run_.add(frame, motion);
    ASSERT_TRUE(estimate.ok) << frame;
    scale_seen_ = estimate.scale_state == ScaleState::kObservable;
    const Eigen::Vector3d seen = estimate.relative.T_a_b.translation(), truth = run_.motionTo(frame).translation();
    if (frame <= 20) return;
    common_ += seen.dot(truth);
    square_ += truth.squaredNorm();
  }
  void addUpTo(int last) {
    for (int frame = 1; frame <= last; ++frame) add(frame);
  }
  void restart(int frame) { run_.start(frame); }

  /// Factor by which motions seemed longer than they were, from the second second on.
  double lengthFactor() const { return common_ / square_; }
  const CameraCorrection& second() const { return *run_.window().calibration().correction(1); }
  double rotationError() const {
    const Eigen::Matrix3d R_true =
        scenario_.rig.camera(1).T_body_cam.linear() * given_.camera(1).T_body_cam.linear().transpose();
    return logSO3(R_true.transpose() * second().R).norm();
  }
  double rotationSigma() const {
    const Eigen::MatrixXd& covariance = run_.window().calibrationCovariance();
    return std::sqrt(covariance.block<3, 3>(second().column, second().column).trace());
  }

 private:
  static TrackSimulationOptions tracksOf(std::uint64_t seed) {
    TrackSimulationOptions options;
    options.seed = seed;
    options.tracks_per_camera = 100;
    return options;
  }

  Scenario scenario_;
  CameraRig given_;
  SimulatedWindow run_;
  std::mt19937 random_;
  bool scale_seen_ = false;
  double common_ = 0.0, square_ = 0.0;
};

TEST(WindowCalibration, FindsHowTheSecondCameraIsTurned) {
  for (std::uint64_t seed : {1, 2, 3}) {
    TurnedStereo with(5.0, seed, true), without(5.0, seed, false);
    with.addUpTo(100);
    without.addUpTo(100);
    std::printf("rotation error %.4f deg, sigma %.4f deg, lengths x %.4f; without calibration x %.4f\n",
                with.rotationError() / kOneDegree, with.rotationSigma() / kOneDegree, with.lengthFactor(),
                without.lengthFactor());
    EXPECT_LT(with.rotationError(), 0.02 * kOneDegree);
    EXPECT_LT(with.rotationSigma(), 0.02 * kOneDegree);
    EXPECT_NEAR(with.lengthFactor(), 1.0, 0.01);
    EXPECT_EQ(without.second().R, Eigen::Matrix3d::Identity());
    EXPECT_GT(std::abs(without.lengthFactor() - 1.0), 0.03);
  }
}

TEST(WindowCalibration, AStartKeepsWhatIsKnown) {
  TurnedStereo again(5.5, 1, true), fresh(5.5, 1, true);
  again.addUpTo(100);
  const double sigma = again.rotationSigma(), error = again.rotationError();
  const Eigen::Matrix3d R = again.second().R;
  for (TurnedStereo* one : {&again, &fresh}) one->restart(100);
  EXPECT_EQ(again.second().R, R);
  for (TurnedStereo* one : {&again, &fresh}) one->add(101);
  EXPECT_LT(again.rotationError(), 1.5 * error + 0.002 * kOneDegree);
  EXPECT_LT(again.rotationSigma(), 1.02 * sigma);
  EXPECT_GT(fresh.rotationSigma(), 2.0 * sigma);
}

/// A window some frames into a run, with what the next frame needs.
struct NextFrame {
  Window window;
  TrackedFrame frame;
  std::vector<Eigen::Isometry3d> T_body_cam;
  MotionSummary motion;

  WindowEstimate add() { return window.add(frame, T_body_cam, motion, {motion.T_a_b}); }
};

// Everything that the next frame needs in a world that is `factor` times as large, seen from camera 0 of the newest.
NextFrame scaled(NextFrame next, double factor) {
  const Eigen::Vector3d first_camera = next.T_body_cam[0].translation();
  next.window.scale(factor, first_camera);
  for (Eigen::Isometry3d& T : next.T_body_cam) {
    T.translation() = first_camera + factor * (T.translation() - first_camera);
  }
  Eigen::Isometry3d& T = next.motion.T_a_b;
  const Eigen::Vector3d arm = T.linear() * first_camera - first_camera;
  T.translation() = factor * (T.translation() + arm) - arm;
  next.motion.translation_covariance *= factor * factor;
  return next;
}

TEST(WindowCalibration, ScalingLeavesTheViewsAsTheyFit) {
  // Nothing in the window may know lengths, and each solution is carried to its end.
  WindowOptions options;
  options.bundle.inverse_distance_sigma = 1e6;
  options.bundle.max_iterations = 100;
  options.bundle.relative_decrease = 0.0;
  const Scenario scenario = makeScenario("handheld_stereo", lasting(3.0));
  TrackSimulationOptions tracks;
  tracks.tracks_per_camera = 120;
  const RigCalibration calibration(scenario.rig, true);
  const Eigen::Vector3d first_camera = scenario.rig.camera(0).T_body_cam.translation();
  SimulatedWindow run(scenario, tracks, 0, scenario.rig, calibration, options);
  std::mt19937 random(1);
  constexpr int kNext = 56;  // by then poses have been marginalized
  Eigen::Vector3d fixed;     // the first camera of the newest state
  for (int frame = 1; frame < kNext; ++frame) {
    const WindowEstimate estimate = run.add(frame, predictedMotion(run.motionTo(frame), {}, 0.05, &random));
    ASSERT_TRUE(estimate.ok);
    fixed = estimate.T_odom_body * first_camera;
  }
  NextFrame plain{run.window(), run.tracks().frames[kNext], run.cameraPoses(),
                  predictedMotion(run.motionTo(kNext), {}, 0.05, &random)};
  for (const double factor : {0.9, 1.03}) {
    NextFrame one = plain, other = scaled(plain, factor);
    const std::vector<Eigen::Vector3d> points = one.window.points(), scaled_points = other.window.points();
    ASSERT_EQ(points.size(), scaled_points.size());
    const WindowEstimate expected = one.add(), estimate = other.add();
    ASSERT_TRUE(expected.ok && estimate.ok);
    for (std::size_t i = 0; i < points.size(); ++i) {
      EXPECT_LT((fixed + factor * (points[i] - fixed) - scaled_points[i]).norm(), 1e-9);
    }
    const auto camera_moved = [&](const WindowEstimate& motion) {
      return Eigen::Vector3d(motion.relative.T_a_b * first_camera - first_camera);
    };
    std::printf("x %.2f: displacement differs by %.1e m, rotation by %.1e rad\n", factor,
                (factor * camera_moved(expected) - camera_moved(estimate)).norm(),
                logSO3(expected.relative.T_a_b.linear().transpose() * estimate.relative.T_a_b.linear()).norm());
    EXPECT_LT((factor * camera_moved(expected) - camera_moved(estimate)).norm(), 1e-9);
    EXPECT_LT(logSO3(expected.relative.T_a_b.linear().transpose() * estimate.relative.T_a_b.linear()).norm(), 1e-9);
    EXPECT_EQ(expected.inliers, estimate.inliers);
    EXPECT_NEAR(expected.pixel_sigma, estimate.pixel_sigma, 1e-9);
  }
}

}  // namespace
}  // namespace multicam_egomotion
