// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <set>

#include "correspondence_scene.h"
#include "multicam_egomotion/estimation/rig_sampler.h"

namespace multicam_egomotion {
namespace {

const Eigen::Vector3d kRotation(0.02, -0.03, 0.05);
const Eigen::Vector3d kTranslation(-0.4, 0.1, 0.05);

CorrespondenceScene sceneOf(const RigShape& rig, int count) {
  return makeCorrespondenceScene(rig, kRotation, kTranslation, count, 0.5, 0.0, 1);
}

TEST(RigSampler, IndicesAreDifferentAndInRange) {
  for (const RigShape& rig : {monoShape(), stereoShape(), surroundShape()}) {
    const CorrespondenceSet set = sceneOf(rig, 7).set();
    RigSampler sampler(set, 3);
    for (int i = 0; i < 1000; ++i) {
      std::array<int, 4> sample;
      ASSERT_TRUE(sampler.draw(4, sample.data()));
      EXPECT_EQ(std::set<int>(sample.begin(), sample.end()).size(), 4u);
      EXPECT_GE(*std::min_element(sample.begin(), sample.end()), 0);
      EXPECT_LT(*std::max_element(sample.begin(), sample.end()), set.size());
    }
  }
}

TEST(RigSampler, SameSeedSameSamplesOtherSeedOthers) {
  const CorrespondenceSet set = sceneOf(stereoShape(), 100).set();
  RigSampler one(set, 42), same(set, 42), other(set, 43);
  int different = 0;
  for (int i = 0; i < 100; ++i) {
    std::array<int, 4> a, b, c;
    one.draw(4, a.data());
    same.draw(4, b.data());
    other.draw(4, c.data());
    EXPECT_EQ(a, b);
    different += a != c;
  }
  EXPECT_GT(different, 95);
}

TEST(RigSampler, TakesACrossCameraCorrespondenceWhereThereIsOne) {
  const CorrespondenceSet set = sceneOf(stereoShape(), 100).set();
  RigSampler sampler(set, 1);
  for (int i = 0; i < 500; ++i) {
    std::array<int, 4> sample;
    sampler.draw(4, sample.data());
    const auto crosses = [&](int index) { return set.rays(index).camera1 != set.rays(index).camera2; };
    EXPECT_TRUE(std::any_of(sample.begin(), sample.end(), crosses));
    std::set<int> pairs;
    for (int index : sample) pairs.insert(set.pairOf(index));
    EXPECT_GT(pairs.size(), 1u);
  }
}

TEST(RigSampler, TakesRaysOfMoreThanOneCameraWhereThereAreSome) {
  const CorrespondenceSet set = sceneOf(surroundShape(), 100).set();
  RigSampler sampler(set, 1);
  for (int i = 0; i < 500; ++i) {
    std::array<int, 4> sample;
    sampler.draw(4, sample.data());
    std::set<int> cameras;
    for (int index : sample) cameras.insert(set.rays(index).camera1);
    EXPECT_GT(cameras.size(), 1u);
  }
}

TEST(RigSampler, ReachesEveryCorrespondence) {
  const CorrespondenceSet set = sceneOf(surroundShape(), 60).set();
  RigSampler sampler(set, 5);
  std::vector<int> drawn(set.size(), 0);
  const int samples = 100 * set.size();
  for (int i = 0; i < samples; ++i) {
    std::array<int, 4> sample;
    sampler.draw(4, sample.data());
    for (int index : sample) ++drawn[index];
  }
  EXPECT_GT(*std::min_element(drawn.begin(), drawn.end()), 4 * 100 / 2);
}

TEST(RigSampler, TooFewCorrespondencesAreRefused) {
  std::array<int, 4> sample;
  for (int count : {0, 3}) {
    const CorrespondenceSet set = sceneOf(monoShape(), count).set();
    RigSampler sampler(set, 1);
    EXPECT_FALSE(sampler.draw(4, sample.data()));
  }
  const CorrespondenceSet four = sceneOf(monoShape(), 4).set();
  RigSampler sampler(four, 1);
  EXPECT_TRUE(sampler.draw(4, sample.data()));
}

}  // namespace
}  // namespace multicam_egomotion
