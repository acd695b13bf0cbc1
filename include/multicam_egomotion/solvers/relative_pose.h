// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>

namespace multicam_egomotion {

/// Relative pose of the body, the paper's T_f2_f1: p_t2 = R p_t1 + t.
struct RelativePose {
  Eigen::Matrix3d R;      ///< R_f2_f1
  Eigen::Vector3d t;      ///< origin of the body frame at t1, seen in the body frame at t2 [m]
  bool scale_observable;  ///< false: only the direction of t is meant (unit length), or t = 0 where no parallax is seen
};

/// Outcome of a minimal solver. Solvers neither throw nor return NaN.
enum class SolverStatus {
  kOk,             ///< solved; there may still be no real solution
  kCentral,        ///< the sample does not determine the pose: one camera pair, coincident centres, repeated rays
  kAxisUndefined,  ///< the prior has no rotation axis
  kInvalidInput,   ///< NaN, infinity, a zero ray, a prior that is not a rotation, a camera index without a centre
};

/// All real solutions of one minimal sample, at most `Capacity`, on the stack. Copies only the valid ones.
template <int Capacity>
struct PoseCandidates {
  static constexpr int kCapacity = Capacity;

  PoseCandidates() {}
  PoseCandidates(const PoseCandidates& other) { *this = other; }
  PoseCandidates& operator=(const PoseCandidates& other) {
    count = other.count;
    status = other.status;
    std::copy(other.begin(), other.end(), poses.begin());
    return *this;
  }

  std::array<RelativePose, Capacity> poses;  ///< the first `count` are valid
  int count = 0;
  SolverStatus status = SolverStatus::kOk;

  const RelativePose* begin() const { return poses.data(); }
  const RelativePose* end() const { return poses.data() + count; }
  int size() const { return count; }
  bool empty() const { return count == 0; }
  const RelativePose& operator[](int i) const { return poses[i]; }
};

/// What every minimal solver can be asked for.
struct SolverOptions {
  bool positive_depths_only = false;  ///< drop poses that put a point of the sample behind one of its rays
  /// Camera centres in the body frame [m], by camera index. Depths count from them; without them from the point of
  /// the ray nearest to the body origin, which differs for points about as near as the rig is large.
  const Eigen::Vector3d* camera_centers = nullptr;
  int camera_count = 0;  ///< length of `camera_centers`
};

}  // namespace multicam_egomotion
