// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "multicam_egomotion/estimation/correspondence_set.h"

namespace multicam_egomotion {

/// Draws minimal samples from which metric scale can be seen where the data allow it: with a cross-camera
/// correspondence where there is one, else from more than one camera. Deterministic by seed, on any platform.
class RigSampler {
 public:
  RigSampler(const CorrespondenceSet& set, std::uint64_t seed);

  /// Fills `sample` with `size` different indices of correspondences; false when there are fewer than `size`.
  bool draw(int size, int* sample);

 private:
  std::uint32_t below(std::uint32_t bound);

  const CorrespondenceSet& set_;
  std::vector<int> cross_camera_;  ///< indices of cross-camera correspondences
  std::uint64_t state_;
};

}  // namespace multicam_egomotion
