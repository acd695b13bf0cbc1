// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "multicam_egomotion/solvers/four_point_kernel.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>

#include "four_point_translation.h"
#include "instruction_sets.h"
#include "sample_checks.h"

#pragma GCC diagnostic ignored "-Wpsabi"

namespace multicam_egomotion {
namespace {

constexpr double kRankTolerance = 1e-6;  // below this F is looked at again with all four rows
constexpr double kVanishing = 1e-14;     // rounding of a determinant of rows of order 1
constexpr double kFarDepth = 1e3;        // of the origin, relative to 1 m and t, beyond which the pose is corrected
constexpr double kParallel = 2e-4;       // sine between the rows, or less, below which it is
constexpr double kLargestSquare = 1e280;
constexpr int kBlock = 8;  // samples solved together

struct ClassifiedSample {
  const RayCorrespondence* rays[4];
  bool central;        // all of one camera pair
  bool three_and_one;  // rays 0 to 2 share a camera pair, ray 3 is of another
};

namespace build_instructions {
#include "lanes.inc"
//
#include "real_roots.inc"
//
#include "four_point_lanes.inc"
//
#include "four_point_solve.inc"
}  // namespace build_instructions

#if MULTICAM_EGOMOTION_DISPATCH_AVX2
#pragma GCC push_options
#pragma GCC target("avx2,fma")
namespace avx2_instructions {
#include "lanes.inc"
//
#include "real_roots.inc"
//
#include "four_point_lanes.inc"
//
#include "four_point_solve.inc"
}  // namespace avx2_instructions
#pragma GCC pop_options
#endif

// The correspondence whose pair the three others share goes last; the origin is one of the three.
ClassifiedSample classify(const std::array<RayCorrespondence, 4>& sample) {
  ClassifiedSample result = {{&sample[0], &sample[1], &sample[2], &sample[3]}, false, false};
  const bool same01 = samePair(sample[0], sample[1]), same23 = samePair(sample[2], sample[3]);
  const bool same02 = samePair(sample[0], sample[2]), same13 = samePair(sample[1], sample[3]);
  int odd = -1;
  if (same01 && same02) odd = 3;
  if (same01 && same13) odd = 2;
  if (same23 && same02) odd = 1;
  if (same23 && same13) odd = 0;
  result.central = same01 && same23 && same02;
  result.three_and_one = odd >= 0 && !result.central;
  if (result.three_and_one) std::swap(result.rays[odd], result.rays[3]);
  return result;
}

}  // namespace

void solveFourPointAboutZ(const std::array<RayCorrespondence, 4>* samples, int count, const ZAlignedFrames& frames,
                          const SolverOptions& options, PoseCandidates<6>* candidates) {
  const bool valid = isRotation(frames.R_aligned_body1) && isRotation(frames.R_aligned_body2);
  for (int first = 0; first < count; first += kBlock) {
    const int block = std::min(kBlock, count - first);
    ClassifiedSample classified[kBlock];
    for (int i = 0; i < block; ++i) {
      const std::array<RayCorrespondence, 4>& sample = samples[first + i];
      classified[i] = classify(sample);
      candidates[first + i].count = 0;
      candidates[first + i].status =
          valid && centersCover(sample, options) ? SolverStatus::kOk : SolverStatus::kInvalidInput;
    }
#if MULTICAM_EGOMOTION_DISPATCH_AVX2
    if (processorHasAvx2()) {
      avx2_instructions::solveBlock(classified, block, frames, options, candidates + first);
      continue;
    }
#endif
    build_instructions::solveBlock(classified, block, frames, options, candidates + first);
  }
}

std::array<double, 7> fourPointPolynomial(const std::array<RayCorrespondence, 4>& sample,
                                          const ZAlignedFrames& frames) {
  const RayCorrespondence* const rays[4] = {&sample[0], &sample[1], &sample[2], &sample[3]};
  build_instructions::AlignedSample aligned;
  build_instructions::alignSample(rays, frames.R_aligned_body1.data(), frames.R_aligned_body2.data(), false, false,
                                  aligned);
  build_instructions::expandDeterminant(aligned);
  std::array<double, 7> coefficients;
  std::copy(aligned.coefficients, aligned.coefficients + 7, coefficients.begin());
  return coefficients;
}

}  // namespace multicam_egomotion
