// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <opencv2/core/utility.hpp>
#include <opencv2/imgproc.hpp>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>

#include "camera_poses.h"
#include "multicam_egomotion/tracking/feature_tracker.h"
#include "simulator/simulator.h"

namespace multicam_egomotion {
namespace {

constexpr int kWidth = 376;
constexpr int kHeight = 240;
constexpr double kWallDistance = 4.0;

// A textured wall z = kWallDistance in front of the world's origin, seen through the full camera model.
class Wall {
 public:
  Wall() {
    cv::RNG random(7);
    cv::Mat coarse(512, 512, CV_8UC1), fine(512, 512, CV_8UC1);
    random.fill(coarse, cv::RNG::UNIFORM, 0, 256);
    random.fill(fine, cv::RNG::UNIFORM, 0, 256);
    cv::GaussianBlur(coarse, coarse, {}, 5.0, 5.0, cv::BORDER_WRAP);
    cv::GaussianBlur(fine, fine, {}, 1.5, 1.5, cv::BORDER_WRAP);
    cv::normalize(coarse, coarse, 0, 255, cv::NORM_MINMAX);
    cv::normalize(fine, fine, 0, 255, cv::NORM_MINMAX);
    cv::addWeighted(coarse, 0.5, fine, 0.5, 0, texture_);
  }

  cv::Mat render(const CameraModel& model, const Eigen::Isometry3d& T_world_cam) const {
    constexpr double kTexelsPerMetre = 60.0;
    cv::Mat u(model.height(), model.width(), CV_32F, cv::Scalar(-1)), v = u.clone(), image;
    for (int y = 0; y < model.height(); ++y) {
      for (int x = 0; x < model.width(); ++x) {
        Eigen::Vector3d bearing;
        if (!model.unproject(Eigen::Vector2d(x, y), &bearing)) continue;
        const Eigen::Vector3d direction = T_world_cam.linear() * bearing;
        if (direction.z() < 0.02) continue;
        const Eigen::Vector3d p =
            T_world_cam.translation() + (kWallDistance - T_world_cam.translation().z()) / direction.z() * direction;
        u.at<float>(y, x) = static_cast<float>(wrap(p.x() * kTexelsPerMetre));
        v.at<float>(y, x) = static_cast<float>(wrap(p.y() * kTexelsPerMetre));
      }
    }
    cv::Mat padded;
    cv::copyMakeBorder(texture_, padded, 0, 4, 0, 4, cv::BORDER_WRAP);
    cv::remap(padded, image, u, v, cv::INTER_LINEAR, cv::BORDER_CONSTANT, cv::Scalar(0));
    return image;
  }

 private:
  static double wrap(double value) { return value - 512.0 * std::floor(value / 512.0); }
  cv::Mat texture_;
};

const Wall& wall() {
  static const Wall wall;
  return wall;
}

RigCamera makeCamera(const std::string& name, Distortion distortion, double x, double yaw_deg) {
  const bool fisheye = distortion == Distortion::kEquidistant;
  const double f = fisheye ? 150.0 : 230.0;
  const std::vector<double> coefficients =
      fisheye ? std::vector<double>{-0.01, 0.004, -0.002, 0.0003} : std::vector<double>{-0.28, 0.07, 0.0002, 0.0001};
  Eigen::Isometry3d T_body_cam = Eigen::Isometry3d::Identity();
  T_body_cam.linear() = Eigen::AngleAxisd(yaw_deg * M_PI / 180, Eigen::Vector3d::UnitY()).toRotationMatrix();
  T_body_cam.translation().x() = x;
  return {name, name, CameraModel(kWidth, kHeight, f, f, 187.0, 119.0, distortion, coefficients), T_body_cam, 0.0};
}

CameraRig stereoRig() {
  return CameraRig(
      {makeCamera("left", Distortion::kRadtan, -0.1, 0.0), makeCamera("right", Distortion::kRadtan, 0.1, 0.0)});
}

FrameSet renderAll(const CameraRig& rig, const Eigen::Isometry3d& T_world_body) {
  FrameSet frames;
  for (int c = 0; c < rig.size(); ++c) {
    frames.images.push_back({c, 0, wall().render(rig.camera(c).model, T_world_body * rig.camera(c).T_body_cam)});
  }
  return frames;
}

FrameSet withNoise(const FrameSet& frames, double sigma, int seed) {
  FrameSet noisy = frames;
  cv::RNG random(seed + 1);
  for (CameraImage& image : noisy.images) {
    cv::Mat noise(image.grey.size(), CV_32F), sum, result;
    random.fill(noise, cv::RNG::NORMAL, 0, sigma);
    image.grey.convertTo(sum, CV_32F);
    sum += noise;
    sum.convertTo(result, CV_8U);
    image.grey = result;
  }
  return noisy;
}

Eigen::Isometry3d pose(double x, double y, double z, double yaw = 0.0) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitY()).toRotationMatrix();
  T.translation() << x, y, z;
  return T;
}

// Point of the wall that a camera sees along an observation.
Eigen::Vector3d wallPoint(const FeatureObservation& o, const CameraRig& rig, const Eigen::Isometry3d& T_world_body) {
  const Eigen::Isometry3d T_world_cam = T_world_body * rig.camera(o.camera).T_body_cam;
  const Eigen::Vector3d d = T_world_cam.linear() * o.bearing;
  return T_world_cam.translation() + (kWallDistance - T_world_cam.translation().z()) / d.z() * d;
}

double pixelError(const FeatureObservation& o, const Eigen::Vector3d& point, const CameraRig& rig,
                  const Eigen::Isometry3d& T_world_body) {
  Eigen::Vector2d pixel;
  const RigCamera& camera = rig.camera(o.camera);
  if (!camera.model.project((T_world_body * camera.T_body_cam).inverse() * point, &pixel)) return 1e9;
  return (pixel - o.pixel).norm();
}

double quantile(std::vector<double> values, double share) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  std::sort(values.begin(), values.end());
  return values[std::min(values.size() - 1, static_cast<std::size_t>(share * values.size()))];
}

using ByTrackAndCamera = std::map<std::pair<TrackId, int>, FeatureObservation>;
ByTrackAndCamera indexed(const TrackedFrame& frame) {
  ByTrackAndCamera result;
  for (const FeatureObservation& o : frame.observations) result.emplace(std::make_pair(o.track, o.camera), o);
  return result;
}

// Errors [px] of cross-camera matches against the wall.
std::vector<double> crossCameraErrors(const TrackedFrame& frame, const CameraRig& rig, const Eigen::Isometry3d& T) {
  std::vector<double> errors;
  for (std::size_t i = 1; i < frame.observations.size(); ++i) {
    const FeatureObservation& first = frame.observations[i - 1];
    const FeatureObservation& second = frame.observations[i];
    if (first.track == second.track) errors.push_back(pixelError(second, wallPoint(first, rig, T), rig, T));
  }
  return errors;
}

TEST(FeatureTracker, FollowsTheWallInTimeAndAcrossCameras) {
  const CameraRig rig = stereoRig();
  FeatureTracker tracker(rig, FeatureTrackerOptions());
  // Where each track was first seen, by camera.
  std::map<std::pair<TrackId, int>, Eigen::Vector3d> origins;
  std::vector<double> temporal;
  for (int k = 0; k < 15; ++k) {
    const auto T = [](int i) { return pose(0.03 * i, -0.01 * i, 0.05 * i, 0.01 * i); };
    // Only the rotation is predicted.
    Eigen::Isometry3d T_prev_cur = Eigen::Isometry3d::Identity();
    T_prev_cur.linear() = T(0).linear().transpose() * T(1).linear();
    const TrackedFrame frame = tracker.track(renderAll(rig, T(k)), T_prev_cur, cameraPosesOf(rig));
    if (k % 5 == 0) tracker.markKeyframe();
    EXPECT_GT(tracker.counters().cross_camera_matches, 60);
    EXPECT_LT(quantile(crossCameraErrors(frame, rig, T(k)), 0.5), 0.15);
    EXPECT_LT(quantile(crossCameraErrors(frame, rig, T(k)), 0.95), 0.6);
    for (const FeatureObservation& o : frame.observations) {
      const auto origin = origins.emplace(std::make_pair(o.track, o.camera), wallPoint(o, rig, T(k))).first;
      if (k == 14) temporal.push_back(pixelError(o, origin->second, rig, T(k)));
    }
  }
  EXPECT_GT(temporal.size(), 150u);
  EXPECT_LT(quantile(temporal, 0.5), 0.15);
  EXPECT_LT(quantile(temporal, 0.95), 0.6);
}

TEST(FeatureTracker, DoesNotDriftWhenStandingStill) {
  const CameraRig rig = stereoRig();
  FeatureTracker tracker(rig, FeatureTrackerOptions());
  constexpr int kFrames = 200, kAverage = 10;
  std::map<std::pair<TrackId, int>, std::vector<Eigen::Vector2d>> paths;
  const FrameSet clean = renderAll(rig, pose(0, 0, 0));
  for (int k = 0; k < kFrames; ++k) {
    const TrackedFrame frame =
        tracker.track(withNoise(clean, 3.0, k), Eigen::Isometry3d::Identity(), cameraPosesOf(rig));
    if (k % 10 == 0) tracker.markKeyframe();
    for (const FeatureObservation& o : frame.observations) paths[{o.track, o.camera}].push_back(o.pixel);
  }
  std::vector<double> drifts;
  for (const auto& [key, path] : paths) {
    if (path.size() < kFrames) continue;
    Eigen::Vector2d drift = Eigen::Vector2d::Zero();
    for (int i = 0; i < kAverage; ++i) drift += (path[kFrames - 1 - i] - path[i]) / kAverage;
    drifts.push_back(drift.norm());
  }
  EXPECT_GT(drifts.size(), 120u);
  EXPECT_LT(quantile(drifts, 0.5), 0.03);
  EXPECT_LT(quantile(drifts, 0.9), 0.08);
}

TEST(FeatureTracker, MatchesTurnedFisheyeNeighbours) {
  const CameraRig rig({makeCamera("left", Distortion::kEquidistant, -0.1, -20.0),
                       makeCamera("right", Distortion::kEquidistant, 0.1, 20.0)});
  FeatureTracker tracker(rig, FeatureTrackerOptions());
  const TrackedFrame frame =
      tracker.track(renderAll(rig, pose(0, 0, 2.0)), Eigen::Isometry3d::Identity(), cameraPosesOf(rig));
  const std::vector<double> errors = crossCameraErrors(frame, rig, pose(0, 0, 2.0));
  EXPECT_GT(errors.size(), 50u);
  EXPECT_LT(quantile(errors, 0.5), 0.2);
  EXPECT_LT(quantile(errors, 0.95), 1.0);
}

// A systematic error along the epipolar line would be one of scale.
TEST(FeatureTracker, MatchesBetweenFisheyesAreUnbiased) {
  const Simulator simulator(makeScenario("drone_fisheye"));
  const CameraRig& rig = simulator.scenario().rig;
  std::vector<double> along;
  for (const int frame : {40, 80, 120, 160}) {
    const Eigen::Isometry3d T_world_body = simulator.stateAtFrame(frame).T_world_body;
    FeatureTracker tracker(rig, FeatureTrackerOptions());
    const TrackedFrame tracked =
        tracker.track(simulator.renderFrame(frame), Eigen::Isometry3d::Identity(), cameraPosesOf(rig));
    for (std::size_t i = 1; i < tracked.observations.size(); ++i) {
      const FeatureObservation& first = tracked.observations[i - 1];
      const FeatureObservation& second = tracked.observations[i];
      if (first.track != second.track) continue;
      const Eigen::Isometry3d T = rig.camera(second.camera).T_body_cam.inverse() * rig.camera(first.camera).T_body_cam;
      const CameraModel& model = rig.camera(second.camera).model;
      const double distance = simulator.distance(first.camera, T_world_body, first.pixel);
      Eigen::Vector2d expected, far;
      if (!model.project(T * (distance * first.bearing), &expected) || !model.project(T.linear() * first.bearing, &far))
        continue;
      if ((expected - far).norm() > 1.0) along.push_back((expected - far).normalized().dot(second.pixel - expected));
    }
  }
  EXPECT_GT(along.size(), 100u);
  EXPECT_LT(std::abs(quantile(along, 0.5)), 0.02);
}

TEST(FeatureTracker, FeaturesLiveOnInTheNeighbourCamera) {
  const CameraRig rig(
      {makeCamera("left", Distortion::kRadtan, -0.3, 0.0), makeCamera("right", Distortion::kRadtan, 0.3, 0.0)});
  FeatureTracker tracker(rig, FeatureTrackerOptions());
  std::set<TrackId> first;
  int handed_over = 0;
  TrackedFrame frame;
  // Sliding to the left, features leave the left camera across its right border.
  for (int k = 0; k < 7; ++k) {
    frame = tracker.track(renderAll(rig, pose(-0.25 * k, 0, 0)), pose(k ? -0.25 : 0, 0, 0), cameraPosesOf(rig));
    if (k == 0) {
      for (const FeatureObservation& o : frame.observations) {
        if (o.camera == 0) first.insert(o.track);
      }
    }
    handed_over += tracker.counters().handed_over;
  }
  EXPECT_GT(handed_over, 3);
  const ByTrackAndCamera now = indexed(frame);
  const auto only_right = [&](TrackId id) { return !now.count({id, 0}) && now.count({id, 1}); };
  EXPECT_GT(std::count_if(first.begin(), first.end(), only_right), 1);
}

TEST(FeatureTracker, IdsAreSortedAndNeverReused) {
  const CameraRig rig = stereoRig();
  FeatureTracker tracker(rig, FeatureTrackerOptions());
  TrackId highest = 0;
  for (int k = 0; k < 4; ++k) {
    const TrackedFrame frame =
        tracker.track(renderAll(rig, pose(0, 0, 0)), Eigen::Isometry3d::Identity(), cameraPosesOf(rig));
    ASSERT_FALSE(frame.observations.empty());
    for (std::size_t i = 1; i < frame.observations.size(); ++i) {
      const FeatureObservation& a = frame.observations[i - 1];
      const FeatureObservation& b = frame.observations[i];
      EXPECT_TRUE(a.track < b.track || (a.track == b.track && a.camera < b.camera));
    }
    EXPECT_GT(frame.observations.front().track, highest);
    highest = frame.observations.back().track;
    tracker.reset();
  }
}

TEST(FeatureTracker, RemovedTracksDoNotComeBack) {
  const CameraRig rig = stereoRig();
  FeatureTracker tracker(rig, FeatureTrackerOptions());
  const FrameSet frames = renderAll(rig, pose(0, 0, 0));
  const TrackedFrame before = tracker.track(frames, Eigen::Isometry3d::Identity(), cameraPosesOf(rig));
  const TrackId removed = before.observations[3].track;
  const TrackId kept = before.observations.back().track;
  tracker.remove({removed, 123456789});
  const TrackedFrame after = tracker.track(frames, Eigen::Isometry3d::Identity(), cameraPosesOf(rig));
  const auto has = [&](TrackId id) {
    return std::any_of(after.observations.begin(), after.observations.end(),
                       [id](const FeatureObservation& o) { return o.track == id; });
  };
  EXPECT_FALSE(has(removed));
  EXPECT_TRUE(has(kept));
}

TEST(FeatureTracker, ObservationsMapBearingsToPixels) {
  const CameraRig rig = stereoRig();
  FeatureTracker tracker(rig, FeatureTrackerOptions());
  const TrackedFrame frame =
      tracker.track(renderAll(rig, pose(0, 0, 0)), Eigen::Isometry3d::Identity(), cameraPosesOf(rig));
  for (const FeatureObservation& o : frame.observations) {
    const Eigen::Vector2d offset(0.3, -0.2);
    Eigen::Vector3d p;
    ASSERT_TRUE(rig.camera(o.camera).model.unproject(o.pixel + offset, &p));
    EXPECT_LT((o.to_pixel * (p / o.bearing.dot(p) - o.bearing) - offset).norm(), 5e-3);
  }
}

TEST(FeatureTracker, MaskIsRespected) {
  const CameraRig rig = stereoRig();
  FeatureTracker tracker(rig, FeatureTrackerOptions());
  cv::Mat mask(kHeight, kWidth, CV_8UC1, cv::Scalar(255));
  mask.colRange(0, kWidth / 2).setTo(0);
  tracker.setMask(0, mask);
  for (int k = 0; k < 3; ++k) {
    const TrackedFrame frame =
        tracker.track(renderAll(rig, pose(0.05 * k, 0, 0)), Eigen::Isometry3d::Identity(), cameraPosesOf(rig));
    bool other_camera_left = false;
    for (const FeatureObservation& o : frame.observations) {
      EXPECT_FALSE(o.camera == 0 && o.pixel.x() < kWidth / 2 - 1.0);
      other_camera_left |= o.camera == 1 && o.pixel.x() < kWidth / 2 - 20;
    }
    EXPECT_TRUE(other_camera_left);
  }
  EXPECT_THROW(tracker.setMask(0, cv::Mat(kHeight, kWidth + 1, CV_8UC1)), std::invalid_argument);
  EXPECT_THROW(tracker.setMask(0, cv::Mat(kHeight, kWidth, CV_16UC1)), std::invalid_argument);
  EXPECT_THROW(tracker.setMask(2, mask), std::invalid_argument);
}

TEST(FeatureTracker, SurvivesBadImages) {
  const CameraRig rig = stereoRig();
  FeatureTracker tracker(rig, FeatureTrackerOptions());
  const FrameSet good = renderAll(rig, pose(0, 0, 0));
  const Eigen::Isometry3d still = Eigen::Isometry3d::Identity();
  const std::size_t usual = tracker.track(good, still, cameraPosesOf(rig)).observations.size();
  for (const int grey : {0, 128, 255}) {
    FrameSet blank = good;
    for (CameraImage& image : blank.images) image.grey = cv::Mat(kHeight, kWidth, CV_8UC1, cv::Scalar(grey));
    EXPECT_TRUE(tracker.track(blank, still, cameraPosesOf(rig)).observations.empty());
    EXPECT_GT(tracker.track(good, still, cameraPosesOf(rig)).observations.size(), usual / 2);
  }
  EXPECT_TRUE(tracker.track(FrameSet(), still, cameraPosesOf(rig)).observations.empty());

  FrameSet wrong = good;
  wrong.images[0].grey = cv::Mat(kHeight / 2, kWidth, CV_8UC1, cv::Scalar(0));
  wrong.images[1].camera = 7;
  wrong.images.push_back({1, 0, cv::Mat()});
  EXPECT_TRUE(tracker.track(wrong, still, cameraPosesOf(rig)).observations.empty());
  EXPECT_EQ(tracker.counters().ignored_images, 3u);
}

TEST(FeatureTracker, MissingCameraStartsAnew) {
  const CameraRig rig = stereoRig();
  FeatureTracker tracker(rig, FeatureTrackerOptions());
  const Eigen::Isometry3d still = Eigen::Isometry3d::Identity();
  const FrameSet both = renderAll(rig, pose(0, 0, 0));
  const TrackedFrame before = tracker.track(both, still, cameraPosesOf(rig));
  FrameSet right_only = both;
  right_only.images.erase(right_only.images.begin());
  const TrackedFrame during = tracker.track(right_only, still, cameraPosesOf(rig));
  const ByTrackAndCamera was = indexed(before);
  int carried_over = 0;
  for (const FeatureObservation& o : during.observations) {
    EXPECT_EQ(o.camera, 1);
    carried_over += was.count({o.track, 1});
  }
  EXPECT_GT(carried_over, 50);
  const TrackedFrame after = tracker.track(both, still, cameraPosesOf(rig));
  EXPECT_GT(std::count_if(after.observations.begin(), after.observations.end(),
                          [](const FeatureObservation& o) { return o.camera == 0; }),
            50);
}

TEST(FeatureTracker, IsDeterministicOnAnyNumberOfThreads) {
  const CameraRig rig = stereoRig();
  FeatureTracker a(rig, FeatureTrackerOptions()), b(rig, FeatureTrackerOptions());
  for (int k = 0; k < 5; ++k) {
    const FrameSet frames = withNoise(renderAll(rig, pose(0.04 * k, 0, 0.1 * k)), 2.0, k);
    cv::setNumThreads(1);
    const TrackedFrame first = a.track(frames, Eigen::Isometry3d::Identity(), cameraPosesOf(rig));
    cv::setNumThreads(-1);  // as many as there are
    const TrackedFrame second = b.track(frames, Eigen::Isometry3d::Identity(), cameraPosesOf(rig));
    ASSERT_EQ(first.observations.size(), second.observations.size());
    for (std::size_t i = 0; i < first.observations.size(); ++i) {
      EXPECT_EQ(first.observations[i].track, second.observations[i].track);
      EXPECT_EQ(first.observations[i].pixel, second.observations[i].pixel);
    }
    EXPECT_EQ(a.counters().tracked, b.counters().tracked);
    EXPECT_EQ(a.counters().cross_camera_matches, b.counters().cross_camera_matches);
  }
}

TEST(FeatureTracker, RefusesWrongOptions) {
  const CameraRig rig = stereoRig();
  const auto refused = [&](auto change) {
    FeatureTrackerOptions options;
    change(options);
    EXPECT_THROW(FeatureTracker(rig, options), std::invalid_argument);
  };
  refused([](FeatureTrackerOptions& o) { o.features_per_camera = 0; });
  refused([](FeatureTrackerOptions& o) { o.patch_size_px = 14; });
  refused([](FeatureTrackerOptions& o) { o.patch_size_px = 31; });
  refused([](FeatureTrackerOptions& o) { o.pyramid_levels = 0; });
  refused([](FeatureTrackerOptions& o) { o.fast_threshold = 300; });
  refused([](FeatureTrackerOptions& o) { o.max_epipolar_error_px = 0; });
  refused([](FeatureTrackerOptions& o) { o.max_forward_backward_error_px = std::nan(""); });
}

}  // namespace
}  // namespace multicam_egomotion
