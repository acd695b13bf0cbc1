// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cstdint>
#include <functional>
#include <vector>

#include "multicam_egomotion/odometry/ego_motion.h"

namespace multicam_egomotion {

/// A recording in memory or read on demand.
struct Recording {
  std::vector<ImuSample> imu;  ///< in time order
  int frames = 0;
  std::function<std::vector<CameraImage>(int frame)> images;  ///< of one frame, all cameras
  std::function<std::int64_t(int frame)> stamp;
};

/// Feeds frames [first, last) with the IMU samples up to a little after each, in the order of a live system. `alter`
/// may change or drop images.
class RecordingPlayer {
 public:
  using Alter = std::function<void(int frame, std::vector<CameraImage>* images)>;
  static constexpr std::int64_t kLag = 10000000;  ///< the IMU is ahead of the images by so much when they arrive [ns]

  explicit RecordingPlayer(const Recording& recording) : recording_(recording) {}

  std::vector<EgoMotionResult> play(EgoMotion* odometry, int first, int last, const Alter& alter = nullptr) {
    std::vector<EgoMotionResult> results;
    for (int frame = first; frame < last; ++frame) {
      const std::int64_t now = recording_.stamp(frame) + kLag;
      while (next_imu_ < recording_.imu.size() && recording_.imu[next_imu_].stamp_ns <= now) {
        odometry->addImu(recording_.imu[next_imu_++]);
        append(odometry->advance(recording_.imu[next_imu_ - 1].stamp_ns), &results);
      }
      std::vector<CameraImage> images = recording_.images(frame);
      if (alter) alter(frame, &images);
      for (const CameraImage& image : images) odometry->addImage(image, now);
      append(odometry->advance(now), &results);
    }
    return results;
  }

 private:
  static void append(const std::vector<EgoMotionResult>& some, std::vector<EgoMotionResult>* all) {
    all->insert(all->end(), some.begin(), some.end());
  }

  const Recording& recording_;
  std::size_t next_imu_ = 0;
};

/// Results of frame sets, without coast ticks.
inline std::vector<EgoMotionResult> ofFrames(const std::vector<EgoMotionResult>& results, const Recording& recording) {
  std::vector<EgoMotionResult> frames;
  for (const EgoMotionResult& one : results) {
    for (int i = 0; i < recording.frames; ++i) {
      if (recording.stamp(i) == one.stamp_ns) frames.push_back(one);
    }
  }
  return frames;
}

template <class Value>
Value medianOf(std::vector<Value> values) {
  if (values.empty()) return Value();
  std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
  return values[values.size() / 2];
}

}  // namespace multicam_egomotion
