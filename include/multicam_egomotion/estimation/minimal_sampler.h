// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "multicam_egomotion/estimation/correspondence_set.h"
#include "multicam_egomotion/estimation/random_index.h"

namespace multicam_egomotion {

enum class Sampling {
  kUniform,   ///< every sample is as likely as any other
  kProsac,    ///< the best correspondences first, by their quality (Chum and Matas 2005)
  kRigAware,  ///< a sample sees metric scale where the data allow it: it has a cross-camera correspondence where there
              ///< is one, and more than one camera pair where there are several
};

/// Draws minimal samples. Deterministic by seed, on any platform.
class MinimalSampler {
 public:
  /// `growth`: number of samples after which PROSAC draws from all correspondences alike.
  MinimalSampler(const CorrespondenceSet& set, Sampling sampling, int sample_size, int growth, std::uint64_t seed);

  /// Fills `sample` with different indices of correspondences; false when there are fewer than a sample.
  bool draw(int* sample);

 private:
  void drawBelow(int bound, int count, int* sample);
  void drawProsac(int* sample);
  void drawRigAware(int* sample);

  const CorrespondenceSet& set_;
  Sampling sampling_;
  int size_;
  RandomIndex random_;
  std::vector<int> cross_camera_;  ///< indices of cross-camera correspondences
  std::vector<int> by_quality_;    ///< indices, best first
  // PROSAC: samples drawn; size of the pool; samples of the growth function from pools up to it (T_n, T'_n).
  int drawn_ = 0, pool_ = 0;
  double pool_share_ = 0.0;
  int pool_until_ = 1;
};

}  // namespace multicam_egomotion
