// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
// CPU time of the tracker and its parts on a sliding synthetic texture, stereo 752x480.
#include <benchmark/benchmark.h>

#include <opencv2/imgproc.hpp>
#include <vector>

#include "multicam_egomotion/tracking/corner_detector.h"
#include "multicam_egomotion/tracking/feature_tracker.h"
#include "multicam_egomotion/tracking/optical_flow.h"

namespace multicam_egomotion {
namespace {

const cv::Size kSize(752, 480);
constexpr double kFocalLength = 458.0;
constexpr double kBaseline = 0.11;  // [m]
constexpr int kDisparity = 20;      // [px]
constexpr int kStep = 4;            // image motion a frame [px]

cv::Mat texture() {
  cv::Mat fine(600, 1600, CV_8UC1), coarse(fine.size(), CV_8UC1), image;
  cv::RNG random(11);
  random.fill(fine, cv::RNG::UNIFORM, 0, 256);
  random.fill(coarse, cv::RNG::UNIFORM, 0, 256);
  cv::GaussianBlur(fine, fine, {}, 1.5);
  cv::GaussianBlur(coarse, coarse, {}, 8);
  cv::normalize(fine, fine, 0, 255, cv::NORM_MINMAX);
  cv::normalize(coarse, coarse, 0, 255, cv::NORM_MINMAX);
  cv::addWeighted(fine, 0.4, coarse, 0.6, 0, image);
  return image;
}

cv::Mat view(const cv::Mat& wall, int x) { return wall(cv::Rect({x, 40}, kSize)).clone(); }

void stereoFrame(benchmark::State& state) {
  cv::setNumThreads(1);
  const CameraModel model(kSize.width, kSize.height, kFocalLength, kFocalLength, 375.5, 239.5, Distortion::kNone, {});
  Eigen::Isometry3d right = Eigen::Isometry3d::Identity();
  right.translation().x() = kBaseline;
  const CameraRig rig(
      {{"left", "left", model, Eigen::Isometry3d::Identity(), 0.0}, {"right", "right", model, right, 0.0}});
  FeatureTrackerOptions options;
  options.features_per_camera = static_cast<int>(state.range(0));
  FeatureTracker tracker(rig, options);
  const double distance = kFocalLength * kBaseline / kDisparity;
  Eigen::Isometry3d T_prev_cur = Eigen::Isometry3d::Identity();

  const cv::Mat wall = texture();
  std::vector<FrameSet> frames;
  for (int x = 40; x < 700; x += kStep) {
    frames.push_back({0, {{0, 0, view(wall, x)}, {1, 0, view(wall, x + kDisparity)}}});
  }
  std::size_t k = 0;
  double tracked = 0;
  for (auto _ : state) {
    if (k == frames.size()) {
      state.PauseTiming();
      tracker.reset();
      k = 0;
      state.ResumeTiming();
    }
    T_prev_cur.translation().x() = k ? distance * kStep / kFocalLength : 0.0;
    tracker.track(frames[k++], T_prev_cur, {Eigen::Isometry3d::Identity(), right});
    if (k % 5 == 0) tracker.markKeyframe();
    tracked += tracker.counters().tracked;
  }
  state.counters["tracked"] = tracked / static_cast<double>(state.iterations());
}
BENCHMARK(stereoFrame)->Arg(150)->Arg(200)->Unit(benchmark::kMillisecond);

void pyramid(benchmark::State& state) {
  cv::setNumThreads(1);
  const cv::Mat image = view(texture(), 40);
  FlowPyramid pyramid;
  for (auto _ : state) {
    pyramid.build(image, OpticalFlowOptions());
    benchmark::DoNotOptimize(pyramid);
  }
}
BENCHMARK(pyramid)->Unit(benchmark::kMillisecond);

void detection(benchmark::State& state) {
  cv::setNumThreads(1);
  const cv::Mat image = view(texture(), 40);
  for (auto _ : state) {
    CornerDetector detector(kSize, CornerDetectorOptions());
    benchmark::DoNotOptimize(detector.detect(image, cv::Mat(), {}));
  }
}
BENCHMARK(detection)->Unit(benchmark::kMillisecond);

void flowForwardOnly(benchmark::State& state) {
  cv::setNumThreads(1);
  const cv::Mat wall = texture();
  const OpticalFlowOptions options;
  FlowPyramid previous, current;
  previous.build(view(wall, 40), options);
  current.build(view(wall, 40 + kStep), options);
  CornerDetector detector(kSize, CornerDetectorOptions());
  const std::vector<cv::Point2f> points = detector.detect(previous.images()[0], cv::Mat(), {});
  std::vector<unsigned char> found;
  for (auto _ : state) {
    std::vector<cv::Point2f> guesses = points;
    flowForward(previous, current, options, static_cast<int>(state.range(0)), points, &guesses, &found);
  }
}
BENCHMARK(flowForwardOnly)->Arg(2)->Arg(4)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace multicam_egomotion

BENCHMARK_MAIN();
