// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <vector>

#include "correspondence_scene.h"
#include "multicam_egomotion/estimation/minimal_sampler.h"

namespace multicam_egomotion {
namespace {

CorrespondenceScene sceneOf(const RigShape& rig, int count) {
  return makeCorrespondenceScene(rig, kRotation, kTranslation, count, 0.5, 0.0, 1);
}

TEST(MinimalSampler, IndicesAreDifferentAndInRange) {
  for (const RigShape& rig : {monoShape(), stereoShape(), surroundShape()}) {
    const CorrespondenceSet set = sceneOf(rig, 7).set();
    MinimalSampler sampler(set, Sampling::kRigAware, 4, 500, 3);
    for (int i = 0; i < 1000; ++i) {
      std::array<int, 4> sample;
      ASSERT_TRUE(sampler.draw(sample.data()));
      EXPECT_EQ(std::set<int>(sample.begin(), sample.end()).size(), 4u);
      EXPECT_GE(*std::min_element(sample.begin(), sample.end()), 0);
      EXPECT_LT(*std::max_element(sample.begin(), sample.end()), set.size());
    }
  }
}

TEST(MinimalSampler, SameSeedSameSamplesOtherSeedOthers) {
  const CorrespondenceSet set = sceneOf(stereoShape(), 100).set();
  MinimalSampler one(set, Sampling::kRigAware, 4, 500, 42), same(set, Sampling::kRigAware, 4, 500, 42),
      other(set, Sampling::kRigAware, 4, 500, 43);
  int different = 0;
  for (int i = 0; i < 100; ++i) {
    std::array<int, 4> a, b, c;
    one.draw(a.data());
    same.draw(b.data());
    other.draw(c.data());
    EXPECT_EQ(a, b);
    different += a != c;
  }
  EXPECT_GT(different, 95);
}

TEST(MinimalSampler, TakesACrossCameraCorrespondenceWhereThereIsOne) {
  const CorrespondenceSet set = sceneOf(stereoShape(), 100).set();
  MinimalSampler sampler(set, Sampling::kRigAware, 4, 500, 1);
  for (int i = 0; i < 500; ++i) {
    std::array<int, 4> sample;
    sampler.draw(sample.data());
    const auto crosses = [&](int index) { return set.rays(index).camera1 != set.rays(index).camera2; };
    EXPECT_TRUE(std::any_of(sample.begin(), sample.end(), crosses));
    std::set<int> pairs;
    for (int index : sample) pairs.insert(set.pairOf(index));
    EXPECT_GT(pairs.size(), 1u);
  }
}

TEST(MinimalSampler, TakesRaysOfMoreThanOneCameraWhereThereAreSome) {
  const CorrespondenceSet set = sceneOf(surroundShape(), 100).set();
  MinimalSampler sampler(set, Sampling::kRigAware, 4, 500, 1);
  for (int i = 0; i < 500; ++i) {
    std::array<int, 4> sample;
    sampler.draw(sample.data());
    std::set<int> cameras;
    for (int index : sample) cameras.insert(set.rays(index).camera1);
    EXPECT_GT(cameras.size(), 1u);
  }
}

TEST(MinimalSampler, ReachesEveryCorrespondence) {
  const CorrespondenceSet set = sceneOf(surroundShape(), 60).set();
  MinimalSampler sampler(set, Sampling::kRigAware, 4, 500, 5);
  std::vector<int> drawn(set.size(), 0);
  const int samples = 100 * set.size();
  for (int i = 0; i < samples; ++i) {
    std::array<int, 4> sample;
    sampler.draw(sample.data());
    for (int index : sample) ++drawn[index];
  }
  EXPECT_GT(*std::min_element(drawn.begin(), drawn.end()), 4 * 100 / 2);
}

TEST(MinimalSampler, TooFewCorrespondencesAreRefused) {
  std::array<int, 4> sample;
  for (int count : {0, 3}) {
    const CorrespondenceSet set = sceneOf(monoShape(), count).set();
    MinimalSampler sampler(set, Sampling::kRigAware, 4, 500, 1);
    EXPECT_FALSE(sampler.draw(sample.data()));
  }
  const CorrespondenceSet four = sceneOf(monoShape(), 4).set();
  MinimalSampler sampler(four, Sampling::kRigAware, 4, 500, 1);
  EXPECT_TRUE(sampler.draw(sample.data()));
}

TEST(MinimalSampler, UniformSamplesAreUniform) {
  const CorrespondenceSet set = sceneOf(stereoShape(), 30).set();
  MinimalSampler sampler(set, Sampling::kUniform, 3, 500, 7);
  std::vector<int> drawn(set.size(), 0);
  const int samples = 400 * set.size();
  for (int i = 0; i < samples; ++i) {
    std::array<int, 3> sample;
    ASSERT_TRUE(sampler.draw(sample.data()));
    for (int index : sample) ++drawn[index];
  }
  for (int count : drawn) EXPECT_NEAR(count, 3 * 400, 5 * std::sqrt(3 * 400.0));
}

TEST(MinimalSampler, ProsacTakesTheBestFirstAndReachesAll) {
  CorrespondenceScene scene = sceneOf(stereoShape(), 100);
  // The later, the better.
  for (std::size_t i = 0; i < scene.entries.size(); ++i) scene.entries[i].quality = static_cast<double>(i);
  const CorrespondenceSet set = scene.set();
  const int growth = 2000;
  MinimalSampler sampler(set, Sampling::kProsac, 4, growth, 3);
  std::array<int, 4> sample;
  double early = 0.0, late = 0.0;
  std::set<int> reached;
  for (int i = 0; i < 2 * growth; ++i) {
    ASSERT_TRUE(sampler.draw(sample.data()));
    EXPECT_EQ(std::set<int>(sample.begin(), sample.end()).size(), 4u);
    for (int index : sample) {
      ASSERT_GE(index, 0);
      ASSERT_LT(index, set.size());
      if (i == 0) {
        EXPECT_GE(index, set.size() - 4);
      }
      if (i < 20) early += index / 80.0;
      if (i >= growth) late += index / (4.0 * growth);
      reached.insert(index);
    }
  }
  EXPECT_GT(early, 0.8 * set.size());
  EXPECT_NEAR(late, 0.5 * set.size(), 0.05 * set.size());
  EXPECT_EQ(static_cast<int>(reached.size()), set.size());
}

}  // namespace
}  // namespace multicam_egomotion
