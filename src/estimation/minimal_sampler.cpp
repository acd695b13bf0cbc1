// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "multicam_egomotion/estimation/minimal_sampler.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace multicam_egomotion {
namespace {
constexpr int kAttempts = 20;  // to find a sample that is not all of one camera pair
}

MinimalSampler::MinimalSampler(const CorrespondenceSet& set, Sampling sampling, int sample_size, int growth,
                               std::uint64_t seed)
    : set_(set), sampling_(sampling), size_(sample_size), random_(seed) {
  if (sampling == Sampling::kRigAware) {
    for (int i = 0; i < set.size(); ++i) {
      if (set.rays(i).camera1 != set.rays(i).camera2) cross_camera_.push_back(i);
    }
  } else if (sampling == Sampling::kProsac) {
    by_quality_.resize(set.size());
    std::iota(by_quality_.begin(), by_quality_.end(), 0);
    std::stable_sort(by_quality_.begin(), by_quality_.end(),
                     [&](int a, int b) { return set.quality(a) > set.quality(b); });
    pool_ = size_;
    pool_share_ = growth;
    for (int i = 0; i < size_; ++i) pool_share_ *= static_cast<double>(size_ - i) / std::max(1, set.size() - i);
  }
}

bool MinimalSampler::draw(int* sample) {
  if (set_.size() < size_) return false;
  switch (sampling_) {
    case Sampling::kUniform:
      drawBelow(set_.size(), 0, sample);
      break;
    case Sampling::kProsac:
      drawProsac(sample);
      break;
    case Sampling::kRigAware:
      drawRigAware(sample);
      break;
  }
  return true;
}

// Fills the sample up from its first `count`, which stay, with different numbers in [0, bound).
void MinimalSampler::drawBelow(int bound, int count, int* sample) {
  while (count < size_) {
    const int index = static_cast<int>(random_.below(static_cast<std::uint32_t>(bound)));
    if (std::find(sample, sample + count, index) == sample + count) sample[count++] = index;
  }
}

void MinimalSampler::drawProsac(int* sample) {
  ++drawn_;
  while (drawn_ > pool_until_ && pool_ < set_.size()) {
    const double next = pool_share_ * (pool_ + 1) / (pool_ + 1 - size_);
    pool_until_ += static_cast<int>(std::ceil(next - pool_share_));
    pool_share_ = next;
    ++pool_;
  }
  if (pool_ < set_.size()) {
    // The newest of the pool with others that are better.
    sample[0] = pool_ - 1;
    drawBelow(pool_ - 1, 1, sample);
  } else {
    drawBelow(pool_, 0, sample);
  }
  for (int i = 0; i < size_; ++i) sample[i] = by_quality_[sample[i]];
}

void MinimalSampler::drawRigAware(int* sample) {
  const bool several_pairs = set_.cameraPairs().size() > 1;
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    int count = 0;
    if (!cross_camera_.empty()) {
      sample[count++] = cross_camera_[random_.below(static_cast<std::uint32_t>(cross_camera_.size()))];
    }
    drawBelow(set_.size(), count, sample);
    if (!several_pairs) return;
    const int first = set_.pairOf(sample[0]);
    if (std::any_of(sample + 1, sample + size_, [&](int i) { return set_.pairOf(i) != first; })) return;
  }
}

}  // namespace multicam_egomotion
