// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "multicam_egomotion/odometry/frame_assembler.h"

namespace multicam_egomotion {
namespace {

constexpr std::int64_t kMs = 1000000;
constexpr std::int64_t kEpoch = 1400000000LL * 1000 * kMs;

std::int64_t at(double ms) { return kEpoch + std::llround(ms * kMs); }

// Feeds images and keeps every set that came out. Times in milliseconds after kEpoch.
class Feed {
 public:
  explicit Feed(int cameras, const FrameAssemblerOptions& options = {}, const std::vector<std::int64_t>& offsets = {})
      : assembler(cameras, options, offsets) {}

  // Number of sets that this image released.
  std::size_t image(int camera, double stamp_ms, double now_ms) {
    assembler.add({camera, at(stamp_ms), pixel_}, at(now_ms));
    return advance(now_ms);
  }
  std::size_t image(int camera, double stamp_ms) { return image(camera, stamp_ms, stamp_ms); }

  std::size_t advance(double now_ms) {
    std::vector<FrameSet> ready = assembler.advance(at(now_ms));
    sets.insert(sets.end(), ready.begin(), ready.end());
    return ready.size();
  }

  std::vector<int> cameras(std::size_t set) const {
    std::vector<int> found;
    for (const CameraImage& image : sets.at(set).images) found.push_back(image.camera);
    return found;
  }

  FrameAssembler assembler;
  std::vector<FrameSet> sets;

 private:
  cv::Mat pixel_ = cv::Mat::zeros(1, 1, CV_8UC1);
};

using Cameras = std::vector<int>;

TEST(FrameAssembler, EmitsTheMomentTheLastLiveCameraDelivers) {
  Feed feed(3);
  EXPECT_EQ(feed.image(2, 0), 0u);
  EXPECT_EQ(feed.image(0, 0, 1), 0u);
  EXPECT_EQ(feed.image(1, 0, 2), 1u);
  EXPECT_EQ(feed.sets[0].stamp_ns, at(0));
  EXPECT_EQ(feed.cameras(0), (Cameras{0, 1, 2}));
  EXPECT_EQ(feed.assembler.counters().sets, 1u);
  EXPECT_EQ(feed.assembler.counters().incomplete_sets, 0u);
}

TEST(FrameAssembler, ImagesKeepTheirStampsAndTheSetHasTheFirstCameras) {
  Feed feed(2);
  feed.image(1, 0);
  feed.image(0, 7);  // as in KITTI raw
  ASSERT_EQ(feed.sets.size(), 1u);
  EXPECT_EQ(feed.sets[0].stamp_ns, at(7));
  EXPECT_EQ(feed.sets[0].images[0].stamp_ns, at(7));
  EXPECT_EQ(feed.sets[0].images[1].stamp_ns, at(0));
}

TEST(FrameAssembler, ImagesFurtherApartThanTheSlopAreNotOneSet) {
  Feed feed(2);
  feed.image(0, 0);
  EXPECT_EQ(feed.image(1, 10.001), 1u);  // cam1 can no longer deliver for 0: cam0's set need not wait
  EXPECT_EQ(feed.cameras(0), Cameras{0});
  feed.advance(100);
  ASSERT_EQ(feed.sets.size(), 2u);
  EXPECT_EQ(feed.cameras(1), Cameras{1});
  EXPECT_EQ(feed.sets[1].stamp_ns, at(10.001));

  Feed within(2);
  within.image(0, 0);
  within.image(1, 10);
  EXPECT_EQ(within.cameras(0), (Cameras{0, 1}));
}

TEST(FrameAssembler, WaitsForTheTimeoutAfterTheFirstImage) {
  Feed feed(2);
  feed.image(0, 0, 20);  // 20 ms of transport
  EXPECT_EQ(feed.advance(69.9), 0u);
  EXPECT_EQ(feed.advance(70), 1u);
  EXPECT_EQ(feed.cameras(0), Cameras{0});
  EXPECT_EQ(feed.assembler.counters().incomplete_sets, 1u);
}

TEST(FrameAssembler, ALateImageIsDroppedAndCounted) {
  Feed feed(2);
  feed.image(0, 0);
  feed.advance(50);
  EXPECT_EQ(feed.image(1, 1, 51), 0u);
  feed.advance(500);
  EXPECT_EQ(feed.sets.size(), 1u);
  EXPECT_EQ(feed.assembler.counters().late_images, 1u);
}

TEST(FrameAssembler, ADeadCameraCostsThreeTimeoutsAndThenNothing) {
  Feed feed(2);
  for (int i = 0; i < 5; ++i) {
    feed.image(0, 50 * i);
    feed.image(1, 50 * i);
  }
  for (int i = 5; i < 8; ++i) {
    EXPECT_TRUE(feed.assembler.live(1));
    EXPECT_EQ(feed.image(0, 50 * i), 0u) << i;
    EXPECT_EQ(feed.advance(50 * i + 50), 1u) << i;
  }
  EXPECT_FALSE(feed.assembler.live(1));
  EXPECT_EQ(feed.assembler.liveCameras(), 1);
  for (int i = 8; i < 20; ++i) EXPECT_EQ(feed.image(0, 50 * i), 1u) << i;
}

TEST(FrameAssembler, ADeadFirstCameraHandsTheReferenceOn) {
  Feed feed(2);
  for (int i = 0; i < 10; ++i) {
    if (i < 2) feed.image(0, 50 * i);
    feed.image(1, 50 * i + 3);
    feed.advance(50 * i + 49.9);
  }
  feed.advance(1000);
  ASSERT_EQ(feed.sets.size(), 10u);
  EXPECT_EQ(feed.sets[1].stamp_ns, at(50));
  EXPECT_EQ(feed.sets[2].stamp_ns, at(103));
  EXPECT_EQ(feed.sets[9].stamp_ns, at(453));
}

// No one waits for a camera that is not live: its first images come after their sets, and must still bring it back.
TEST(FrameAssembler, ACameraReturnsThoughItsImagesComeLast) {
  Feed feed(2);
  for (int i = 0; i < 30; ++i) {
    feed.image(0, 50 * i, 50 * i + 5);
    if (i < 3 || i >= 15) feed.image(1, 50 * i - 2, 50 * i + 8);
    feed.advance(50 * i + 49);
  }
  EXPECT_TRUE(feed.assembler.live(1));
  feed.advance(5000);
  ASSERT_EQ(feed.sets.size(), 30u);
  EXPECT_EQ(feed.cameras(14), Cameras{0});
  for (std::size_t i = 16; i < 30; ++i) EXPECT_EQ(feed.cameras(i), (Cameras{0, 1})) << i;
}

TEST(FrameAssembler, ALostFrameDoesNotEndTheWaiting) {
  Feed feed(2);
  for (int i = 0; i < 40; ++i) {
    feed.image(0, 50 * i, 50 * i + 1);
    if (i % 7 != 6) feed.image(1, 50 * i, 50 * i + 10);
    feed.advance(50 * i + 52);
  }
  ASSERT_EQ(feed.sets.size(), 40u);
  for (int i = 0; i < 40; ++i) EXPECT_EQ(feed.cameras(i).size(), i % 7 != 6 ? 2u : 1u) << i;
  EXPECT_EQ(feed.assembler.counters().late_images, 0u);
}

class SlowCamera : public testing::TestWithParam<int> {};

// A camera at a fraction of the rate is neither waited for nor taken for dead between its images.
TEST_P(SlowCamera, IsNotMissingBetweenItsImages) {
  const int every = GetParam();
  Feed feed(2);
  for (int i = 0; i < 60; ++i) {
    const std::size_t with_fast = feed.image(0, 50 * i, 50 * i + 1);
    const bool slow_delivers = i % every == 0;
    if (i > 2 * every) {
      EXPECT_TRUE(feed.assembler.live(1)) << i;
      EXPECT_EQ(with_fast, slow_delivers ? 0u : 1u) << i;
    }
    if (slow_delivers) feed.image(1, 50 * i, 50 * i + 4);
    feed.advance(50 * i + 50.9);
    if (i > 2 * every) {
      EXPECT_EQ(feed.sets.back().images.size(), slow_delivers ? 2u : 1u) << i;
    }
  }
  EXPECT_EQ(feed.sets.size(), 60u);
}

INSTANTIATE_TEST_SUITE_P(EveryNth, SlowCamera, testing::Values(2, 3, 4, 8));

TEST(FrameAssembler, MinCamerasDropsSmallSets) {
  FrameAssemblerOptions options;
  options.min_cameras = 2;
  Feed feed(3, options);
  feed.image(0, 0);
  feed.advance(50);
  EXPECT_EQ(feed.sets.size(), 0u);
  EXPECT_EQ(feed.assembler.counters().too_small_sets, 1u);
  feed.image(0, 100);
  feed.image(2, 100);
  feed.advance(150);
  ASSERT_EQ(feed.sets.size(), 1u);
  EXPECT_EQ(feed.cameras(0), (Cameras{0, 2}));
}

TEST(FrameAssembler, TimeOffsetsAreAppliedToMatchingOnly) {
  Feed feed(2, {}, {0, -30 * kMs});
  feed.image(0, 0);
  feed.image(1, 30);
  ASSERT_EQ(feed.sets.size(), 1u);
  EXPECT_EQ(feed.sets[0].stamp_ns, at(0));
  EXPECT_EQ(feed.sets[0].images[1].stamp_ns, at(30));
}

TEST(FrameAssembler, DuplicatesAreDropped) {
  Feed feed(2);
  feed.image(0, 0);
  feed.image(0, 0);
  feed.image(1, 0);
  feed.image(1, 0);
  feed.advance(200);
  ASSERT_EQ(feed.sets.size(), 1u);
  EXPECT_EQ(feed.sets[0].images.size(), 2u);
  EXPECT_EQ(feed.assembler.counters().duplicate_images, 2u);
  EXPECT_EQ(feed.assembler.counters().late_images, 0u);
}

TEST(FrameAssembler, SwappedImagesAreUsedInOrderIfInTime) {
  Feed feed(2);
  feed.image(0, 50);
  feed.image(0, 0);
  feed.image(1, 0);
  feed.image(1, 50);
  ASSERT_EQ(feed.sets.size(), 2u);
  EXPECT_EQ(feed.sets[0].stamp_ns, at(0));
  EXPECT_EQ(feed.sets[1].stamp_ns, at(50));
  EXPECT_EQ(feed.sets[1].images.size(), 2u);
  EXPECT_EQ(feed.assembler.counters().out_of_order_images, 1u);
}

TEST(FrameAssembler, InvalidImagesAreCounted) {
  FrameAssembler assembler(2, {});
  const cv::Mat pixel = cv::Mat::zeros(1, 1, CV_8UC1);
  assembler.add({2, at(0), pixel}, at(0));
  assembler.add({-1, at(0), pixel}, at(0));
  assembler.add({0, 0, pixel}, at(0));
  assembler.add({0, at(0), cv::Mat()}, at(0));
  EXPECT_TRUE(assembler.advance(at(1000)).empty());
  EXPECT_EQ(assembler.counters().invalid_images, 4u);
}

class WildStamp : public testing::TestWithParam<double> {};

// One absurd stamp, hours ahead or behind, costs its own image and no other.
TEST_P(WildStamp, CostsOneImage) {
  Feed feed(2);
  for (int i = 0; i < 20; ++i) {
    feed.image(0, 50 * i + (i == 10 ? GetParam() : 0.0), 50 * i);
    feed.image(1, 50 * i);
  }
  feed.advance(2000);
  ASSERT_EQ(feed.sets.size(), 20u);
  for (int i = 0; i < 20; ++i) EXPECT_EQ(feed.cameras(i).size(), i == 10 ? 1u : 2u) << i;
  EXPECT_EQ(feed.assembler.counters().implausible_stamps, 1u);
  EXPECT_EQ(feed.assembler.counters().time_jumps_back, 0u);
}

INSTANTIATE_TEST_SUITE_P(Offsets, WildStamp, testing::Values(1e7, 1500.0, -1500.0, -1e7));

TEST(FrameAssembler, FollowsStampsThatStayAhead) {
  Feed feed(1);
  for (int i = 0; i < 20; ++i) feed.image(0, 50 * i + (i >= 10 ? 3.6e6 : 0.0), 50 * i);
  EXPECT_EQ(feed.sets.size(), 18u);
  EXPECT_EQ(feed.sets.back().stamp_ns, at(950 + 3.6e6));
  EXPECT_EQ(feed.assembler.counters().time_jumps_back, 0u);
}

TEST(FrameAssembler, ReportsStampsThatStayBehindAndStartsAfreshOnReset) {
  Feed feed(2);
  for (int i = 200; i < 210; ++i) {
    feed.image(0, 50 * i);
    feed.image(1, 50 * i);
  }
  ASSERT_EQ(feed.sets.size(), 10u);
  int images = 0;  // the stream starts again from 0 while data time goes on
  for (; feed.assembler.counters().time_jumps_back == 0 && images < 20; ++images) {
    feed.image(images % 2, 50 * (images / 2), 50 * (210 + images / 2));
  }
  EXPECT_LE(images, 6);
  feed.assembler.reset();
  for (int i = 5; i < 10; ++i) {
    feed.image(0, 50 * i, 50 * (215 + i));
    EXPECT_EQ(feed.image(1, 50 * i, 50 * (215 + i)), 1u);
  }
  EXPECT_EQ(feed.sets.back().stamp_ns, at(450));
  EXPECT_EQ(feed.assembler.counters().sets, 15u);
}

TEST(FrameAssembler, ReportsDataTimeThatGoesBackAtOnce) {
  Feed feed(1);
  feed.image(0, 10000);
  EXPECT_EQ(feed.assembler.counters().time_jumps_back, 0u);
  feed.image(0, 0);
  EXPECT_EQ(feed.assembler.counters().time_jumps_back, 1u);
}

TEST(FrameAssembler, GoesOnAfterALongPause) {
  Feed feed(2);
  for (const double start : {0.0, 60000.0}) {
    for (int i = 0; i < 5; ++i) {
      feed.image(0, start + 50 * i);
      feed.image(1, start + 50 * i);
    }
  }
  // A recording that is paused: data time goes on, stamps do not.
  feed.image(0, 60250, 120000);
  feed.image(1, 60250, 120000);
  EXPECT_EQ(feed.sets.size(), 11u);
  EXPECT_EQ(feed.assembler.counters().implausible_stamps, 0u);
}

TEST(FrameAssembler, ResetForgetsPendingImagesAndLiveness) {
  Feed feed(2);
  for (int i = 0; i < 6; ++i) {
    feed.image(0, 50 * i);
    feed.advance(50 * i + 49.9);
  }
  EXPECT_FALSE(feed.assembler.live(1));
  feed.assembler.reset();
  EXPECT_TRUE(feed.assembler.live(1));
  const std::size_t before = feed.sets.size();
  EXPECT_EQ(feed.advance(10000), 0u);
  EXPECT_EQ(feed.sets.size(), before);
}

TEST(FrameAssembler, MemoryIsBoundedWhileTimeStandsStill) {
  Feed feed(2);
  for (int i = 0; i < 1000; ++i) feed.image(0, i, 0);
  EXPECT_EQ(feed.assembler.counters().overflow_images, 1000u - 16u);
}

// Eight cameras with jitter, transport delay, lost, repeated and swapped images: every set keeps the contract.
TEST(FrameAssembler, KeepsTheContractUnderRandomFaults) {
  struct Event {
    int camera;
    double stamp_ms, arrival_ms;
  };
  for (unsigned seed = 0; seed < 20; ++seed) {
    std::mt19937 generator(seed);
    std::uniform_real_distribution<double> uniform(0, 1);
    std::vector<Event> events;
    const int cameras = 1 + static_cast<int>(seed % 8);
    for (int i = 0; i < 200; ++i) {
      for (int camera = 0; camera < cameras; ++camera) {
        if (uniform(generator) < 0.05) continue;
        const double stamp = 50 * i + 4 * uniform(generator);
        events.push_back({camera, stamp, stamp + 60 * uniform(generator)});
        if (uniform(generator) < 0.05) events.push_back({camera, stamp, stamp + 100 * uniform(generator)});
      }
    }
    std::stable_sort(events.begin(), events.end(),
                     [](const Event& a, const Event& b) { return a.arrival_ms < b.arrival_ms; });
    Feed feed(cameras);
    for (const Event& event : events) feed.image(event.camera, event.stamp_ms, event.arrival_ms);
    feed.advance(1e5);

    const FrameAssemblerCounters& counters = feed.assembler.counters();
    std::size_t used = 0;
    for (std::size_t i = 0; i < feed.sets.size(); ++i) {
      const FrameSet& set = feed.sets[i];
      used += set.images.size();
      EXPECT_GT(set.stamp_ns, i > 0 ? feed.sets[i - 1].stamp_ns : 0);
      EXPECT_EQ(set.stamp_ns, set.images.front().stamp_ns);
      for (std::size_t k = 1; k < set.images.size(); ++k) {
        EXPECT_LT(set.images[k - 1].camera, set.images[k].camera);
        EXPECT_LE(std::abs(set.images[k].stamp_ns - set.stamp_ns), 10 * kMs);
      }
    }
    EXPECT_EQ(used + counters.late_images + counters.duplicate_images, events.size());
    EXPECT_EQ(counters.sets, feed.sets.size());
    EXPECT_GT(feed.sets.size(), 150u);
  }
}

void expectRefusal(int cameras, const FrameAssemblerOptions& options, const std::vector<std::int64_t>& offsets,
                   const std::string& name) {
  try {
    FrameAssembler(cameras, options, offsets);
    ADD_FAILURE() << "accepted: " << name;
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find(name), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find("expected"), std::string::npos) << error.what();
  }
}

TEST(FrameAssembler, WrongOptionsThrow) {
  expectRefusal(0, {}, {}, "number of cameras is 0");
  expectRefusal(2, {}, {0}, "number of time offsets is 1");
  FrameAssemblerOptions options;
  options.min_cameras = 3;
  expectRefusal(2, options, {}, "min_cameras is 3");
  options = {};
  options.sync_slop_s = -0.1;
  expectRefusal(2, options, {}, "sync_slop_s is -0.1");
  options = {};
  options.sync_timeout_s = std::numeric_limits<double>::quiet_NaN();
  expectRefusal(2, options, {}, "sync_timeout_s is nan");
}

}  // namespace
}  // namespace multicam_egomotion
