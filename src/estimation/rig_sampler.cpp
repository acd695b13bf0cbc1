// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "multicam_egomotion/estimation/rig_sampler.h"

#include <algorithm>

namespace multicam_egomotion {
namespace {
constexpr int kAttempts = 20;  // to find a sample that is not all of one camera pair
}

RigSampler::RigSampler(const CorrespondenceSet& set, std::uint64_t seed) : set_(set), state_(seed) {
  for (int i = 0; i < set.size(); ++i) {
    if (set.rays(i).camera1 != set.rays(i).camera2) cross_camera_.push_back(i);
  }
}

// SplitMix64 (Steele, Lea and Flood 2014) reduced to [0, bound) by multiplication.
std::uint32_t RigSampler::below(std::uint32_t bound) {
  std::uint64_t z = (state_ += 0x9e3779b97f4a7c15ULL);
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
  z ^= z >> 31;
  return static_cast<std::uint32_t>(((z >> 32) * bound) >> 32);
}

bool RigSampler::draw(int size, int* sample) {
  if (set_.size() < size) return false;
  const bool several_pairs = set_.cameraPairs().size() > 1;
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    int count = 0;
    if (!cross_camera_.empty())
      sample[count++] = cross_camera_[below(static_cast<std::uint32_t>(cross_camera_.size()))];
    while (count < size) {
      const int index = static_cast<int>(below(static_cast<std::uint32_t>(set_.size())));
      if (std::find(sample, sample + count, index) == sample + count) sample[count++] = index;
    }
    if (!several_pairs) return true;
    const int first = set_.pairOf(sample[0]);
    if (std::any_of(sample + 1, sample + size, [&](int i) { return set_.pairOf(i) != first; })) return true;
  }
  return true;
}

}  // namespace multicam_egomotion
