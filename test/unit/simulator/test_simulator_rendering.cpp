// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/features2d.hpp>
#include <opencv2/video/tracking.hpp>
#include <vector>

#include "simulator/simulator.h"

namespace multicam_egomotion {
namespace {

cv::Mat toBytes(const cv::Mat& image) { return addImageNoise(image, 0.0, 1, 1); }

/// Errors of KLT against the geometry, between two cameras and body poses.
struct TrackingError {
  std::vector<double> x, y, norm;

  void compare(const Simulator& simulator, int camera1, const Eigen::Isometry3d& T_world_body1, int camera2,
               const Eigen::Isometry3d& T_world_body2) {
    const cv::Mat first = toBytes(simulator.renderImage(camera1, T_world_body1));
    const cv::Mat second = toBytes(simulator.renderImage(camera2, T_world_body2));
    const RigCamera& a = simulator.scenario().rig.camera(camera1);
    const RigCamera& b = simulator.scenario().rig.camera(camera2);
    std::vector<cv::KeyPoint> corners;
    cv::FAST(first, corners, 25);
    std::vector<cv::Point2f> from, truth;
    for (std::size_t i = 0; i < corners.size(); i += 7) {
      const Eigen::Vector2d pixel(corners[i].pt.x, corners[i].pt.y);
      Eigen::Vector3d bearing;
      Eigen::Vector2d projected;
      if (!a.model.contains(pixel, 20.0) || !a.model.unproject(pixel, &bearing)) continue;
      const double distance = simulator.distance(camera1, T_world_body1, pixel);
      // Patches on one surface only: what lies behind an edge moves differently.
      bool smooth = std::isfinite(distance);
      for (const double dx : {-12.0, 0.0, 12.0}) {
        for (const double dy : {-12.0, 0.0, 12.0}) {
          const double near = simulator.distance(camera1, T_world_body1, pixel + Eigen::Vector2d(dx, dy));
          smooth = smooth && std::abs(near - distance) < 0.12 * distance;
        }
      }
      const Eigen::Vector3d point = T_world_body1 * a.T_body_cam * (distance * bearing);
      if (!smooth || !b.model.project((T_world_body2 * b.T_body_cam).inverse() * point, &projected)) continue;
      if (!b.model.contains(projected, 20.0)) continue;
      from.push_back(corners[i].pt);
      truth.emplace_back(static_cast<float>(projected.x()), static_cast<float>(projected.y()));
    }
    ASSERT_GT(from.size(), 50u);
    std::vector<cv::Point2f> to = truth;
    std::vector<std::uint8_t> found;
    std::vector<float> residual;
    cv::calcOpticalFlowPyrLK(first, second, from, to, found, residual, cv::Size(15, 15), 0,
                             cv::TermCriteria(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 30, 0.001),
                             cv::OPTFLOW_USE_INITIAL_FLOW);
    for (std::size_t i = 0; i < from.size(); ++i) {
      const cv::Point2f error = to[i] - truth[i];
      // Hidden in the second image: not a matter of precision.
      if (!found[i] || std::hypot(error.x, error.y) > 2.0) continue;
      x.push_back(error.x);
      y.push_back(error.y);
      norm.push_back(std::hypot(error.x, error.y));
    }
  }

  static double mean(const std::vector<double>& values) {
    double sum = 0.0;
    for (const double value : values) sum += value;
    return sum / static_cast<double>(values.size());
  }
  static double median(std::vector<double> values) {
    std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
    return values[values.size() / 2];
  }
};

class SimulatorRendering : public testing::TestWithParam<std::string> {};

TEST_P(SimulatorRendering, FeaturesMoveAsTheGeometrySays) {
  SimulationOptions options;
  options.duration_s = 8.0;
  const Simulator simulator(makeScenario(GetParam(), options));
  TrackingError error;
  for (const int frame : {30, 70}) {
    const Eigen::Isometry3d T = simulator.stateAtFrame(frame).T_world_body;
    // Small motions with parts of a pixel in all directions.
    const Eigen::Isometry3d moved = T * Eigen::Translation3d(0.013, -0.011, 0.007) *
                                    Eigen::AngleAxisd(0.004, Eigen::Vector3d(0.3, -0.8, 0.5).normalized());
    for (int camera = 0; camera < std::min(2, simulator.scenario().rig.size()); ++camera) {
      error.compare(simulator, camera, T, camera, moved);
    }
  }
  RecordProperty("median_px", std::to_string(TrackingError::median(error.norm)));
  EXPECT_LT(std::abs(TrackingError::mean(error.x)), 0.05);
  EXPECT_LT(std::abs(TrackingError::mean(error.y)), 0.05);
  EXPECT_LT(TrackingError::median(error.norm), 0.1);
}

INSTANTIATE_TEST_SUITE_P(Scenarios, SimulatorRendering,
                         testing::Values("handheld_stereo", "car_surround", "drone_fisheye"),
                         [](const auto& info) { return info.param; });

TEST(SimulatorImages, DoNotDependOnThreadsAndDoDependOnTheSeed) {
  SimulationOptions options;
  options.duration_s = 0.2;
  const Simulator simulator(makeScenario("handheld_stereo", options));
  const FrameSet one = simulator.renderFrame(2, 1), three = simulator.renderFrame(2, 3);
  ASSERT_EQ(one.images.size(), 2u);
  EXPECT_EQ(one.stamp_ns, Simulator::kFirstStamp + 100000000);
  for (int i = 0; i < 2; ++i) EXPECT_EQ(cv::norm(one.images[i].grey, three.images[i].grey, cv::NORM_INF), 0.0);
  options.seed = 2;
  const FrameSet other = Simulator(makeScenario("handheld_stereo", options)).renderFrame(2);
  EXPECT_GT(cv::norm(one.images[0].grey, other.images[0].grey, cv::NORM_L1) / (640 * 480), 10.0);
}

TEST(SimulatorImages, NoiseHasItsSigma) {
  const cv::Mat flat(480, 640, CV_32FC1, cv::Scalar(100.0));
  cv::Scalar mean, sigma;
  cv::meanStdDev(addImageNoise(flat, 1.5, 3, 4), mean, sigma);
  EXPECT_NEAR(mean[0], 100.0, 0.02);
  EXPECT_NEAR(sigma[0], std::sqrt(1.5 * 1.5 + 1.0 / 12.0), 0.03);
}

TEST(SimulatorImages, HaveCornersEverywhere) {
  for (const std::string& name : scenarioNames()) {
    SimulationOptions options;
    options.duration_s = 5.0;
    const Simulator simulator(makeScenario(name, options));
    for (const CameraImage& image : simulator.renderFrame(25).images) {
      std::vector<cv::KeyPoint> corners;
      cv::FAST(image.grey, corners, 20);
      EXPECT_GT(corners.size(), 1000u) << name << " camera " << image.camera;
    }
  }
}

TEST(SimulatorScene, RaysMeetTheHallAndTheBox) {
  const Scene scene({{0, 0, 2}, {5, 4, 2}, 0.0}, {{{3, 0, 1}, {0.5, 0.5, 1}, 0.25 * M_PI}}, true, 1);
  const Eigen::Vector3d origin(0, 0, 1);
  const SceneHit box = scene.castRay(origin, Eigen::Vector3d::UnitX());
  EXPECT_NEAR(box.distance, 3.0 - std::sqrt(0.5), 1e-9);
  const SceneHit wall = scene.castRay(origin, -Eigen::Vector3d::UnitX());
  EXPECT_NEAR(wall.distance, 5.0, 1e-12);
  EXPECT_NEAR(std::abs(wall.normal.x()), 1.0, 1e-12);
  EXPECT_NEAR(scene.castRay(origin, -Eigen::Vector3d::UnitZ()).distance, 1.0, 1e-12);
  EXPECT_EQ(scene.castRay(origin, Eigen::Vector3d::UnitZ()).surface, -1);
  EXPECT_NEAR(scene.castRay({3, 0, 3}, -Eigen::Vector3d::UnitZ()).distance, 1.0, 1e-12);
}

}  // namespace
}  // namespace multicam_egomotion
