// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <vector>

#include "multicam_egomotion/odometry/ego_motion_result.h"
#include "multicam_egomotion/tracking/frame_set.h"

namespace multicam_egomotion {

/// The last images of each camera with the wall time at which they arrived, for latency and pictures.
class RecentImages {
 public:
  using WallTime = std::chrono::steady_clock::time_point;

  explicit RecentImages(int cameras) : images_(cameras) {}

  void add(const CameraImage& image, WallTime arrival) {
    std::deque<Entry>& recent = images_[image.camera];
    recent.push_back({image.stamp_ns, image.grey, arrival});
    if (recent.size() > kKept) recent.pop_front();
  }

  /// Empty when it is not known any more.
  cv::Mat find(int camera, std::int64_t stamp_ns) const {
    const Entry* entry = entryOf(camera, stamp_ns);
    return entry == nullptr ? cv::Mat() : entry->grey;
  }

  /// When the last image of the result's frame set arrived; nothing for a coast tick.
  std::optional<WallTime> lastArrival(const EgoMotionResult& result) const {
    std::optional<WallTime> last;
    for (std::size_t camera = 0; camera < result.image_stamps_ns.size(); ++camera) {
      const Entry* entry = entryOf(static_cast<int>(camera), result.image_stamps_ns[camera]);
      if (entry != nullptr && (!last || entry->arrival > *last)) last = entry->arrival;
    }
    return last;
  }

 private:
  static constexpr std::size_t kKept = 10;  // more than an image waits for its set and its IMU data at 30 Hz

  struct Entry {
    std::int64_t stamp_ns;
    cv::Mat grey;
    WallTime arrival;
  };

  const Entry* entryOf(int camera, std::int64_t stamp_ns) const {
    for (const Entry& entry : images_[camera]) {
      if (entry.stamp_ns == stamp_ns) return &entry;
    }
    return nullptr;
  }

  std::vector<std::deque<Entry>> images_;
};

}  // namespace multicam_egomotion
