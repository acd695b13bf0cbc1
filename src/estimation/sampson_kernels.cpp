// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sampson_kernels.h"

#include <cmath>
#include <cstring>
#include <limits>

#include "../solvers/instruction_sets.h"

#pragma GCC diagnostic ignored "-Wpsabi"

namespace multicam_egomotion {
namespace {

namespace build_instructions {
#include "sampson_lanes.inc"
}

#if MULTICAM_EGOMOTION_DISPATCH_AVX2
#pragma GCC push_options
#pragma GCC target("avx2,fma")
namespace avx2_instructions {
#include "sampson_lanes.inc"
}
#pragma GCC pop_options
#endif

// Without a baseline there is no epipolar line: the distance of the bearings after the rotation [px].
template <class T>
double rotationError(const RayBlock<T>& block, int place, const Eigen::Matrix3d& R) {
  const Eigen::Vector3d d1(block.x1[place], block.y1[place], block.z1[place]);
  const Eigen::Vector3d d2(block.x2[place], block.y2[place], block.z2[place]);
  const double square = static_cast<double>(block.k1[place]) + static_cast<double>(block.k2[place]);
  return square > 0.0 ? (R * d1 - d2).norm() / std::sqrt(square) : 0.0;
}

bool withoutBaseline(const PairGeometry& geometry) { return geometry.baseline.isZero(0.0); }

}  // namespace

double sumOfLosses(const RayBlock<float>* blocks, int count, const PairGeometry& geometry, const RobustLoss& loss) {
  if (withoutBaseline(geometry)) {
    double sum = 0.0;
    for (int i = 0; i < count; ++i) {
      for (int k = 0; k < RayBlock<float>::kSize; ++k) sum += loss.value(rotationError(blocks[i], k, geometry.R));
    }
    return sum;
  }
#if MULTICAM_EGOMOTION_DISPATCH_AVX2
  if (processorHasAvx2()) return avx2_instructions::sumOfLosses(blocks, count, geometry, loss);
#endif
  return build_instructions::sumOfLosses(blocks, count, geometry, loss);
}

template <class T>
void accumulateAny(const RayBlock<T>* blocks, int count, const PairGeometry& geometry, const RobustLoss& loss,
                   PairSums* sums) {
  if (withoutBaseline(geometry)) {
    for (int i = 0; i < count; ++i) {
      for (int k = 0; k < RayBlock<T>::kSize; ++k) {
        sums->loss += blocks[i].weight[k] * loss.value(rotationError(blocks[i], k, geometry.R));
      }
    }
    return;
  }
#if MULTICAM_EGOMOTION_DISPATCH_AVX2
  if (processorHasAvx2()) return avx2_instructions::accumulate(blocks, count, geometry, loss, sums);
#endif
  build_instructions::accumulate(blocks, count, geometry, loss, sums);
}

void accumulate(const RayBlock<double>* blocks, int count, const PairGeometry& geometry, const RobustLoss& loss,
                PairSums* sums) {
  accumulateAny(blocks, count, geometry, loss, sums);
}
void accumulate(const RayBlock<float>* blocks, int count, const PairGeometry& geometry, const RobustLoss& loss,
                PairSums* sums) {
  accumulateAny(blocks, count, geometry, loss, sums);
}

void evaluateRays(const RayBlock<double>* blocks, int count, const PairGeometry& geometry, double limit,
                  RayResidual* residuals) {
  if (withoutBaseline(geometry)) {
    for (int i = 0; i < count; ++i) {
      for (int k = 0; k < RayBlock<double>::kSize; ++k)
        *residuals++ = {rotationError(blocks[i], k, geometry.R), 0.0, 0.0};
    }
    return;
  }
#if MULTICAM_EGOMOTION_DISPATCH_AVX2
  if (processorHasAvx2()) return avx2_instructions::evaluateRays(blocks, count, geometry, limit, residuals);
#endif
  build_instructions::evaluateRays(blocks, count, geometry, limit, residuals);
}

}  // namespace multicam_egomotion
