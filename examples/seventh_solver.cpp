// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Adds a solver of one's own to the robust estimator: 3pt-rotation, the metric translation where the rotation is known.
// With a = R x1 the generalized epipolar constraint is linear in t:  (a × x2) · t = -(a · q2 + x2 · R q1).
#include <cstdio>
#include <random>

#include "multicam_egomotion/estimation/robust_estimator.h"
#include "multicam_egomotion/geometry/so3.h"

using namespace multicam_egomotion;

struct ThreePointRotation {
  static constexpr int kSampleSize = 3;
  using Prior = Eigen::Matrix3d;  // R_f2_f1
  static PoseCandidates<1> solve(const std::array<RayCorrespondence, 3>& sample, const Prior& R, const SolverOptions&) {
    Eigen::Matrix3d A;
    Eigen::Vector3d b;
    for (int i = 0; i < 3; ++i) {
      const Ray &first = sample[i].first, &second = sample[i].second;
      const Eigen::Vector3d a = R * first.direction;
      A.row(i) = a.cross(second.direction);
      b[i] = -a.dot(second.moment) - second.direction.dot(R * first.moment);
    }
    PoseCandidates<1> result;
    const Eigen::Vector3d t = A.inverse() * b;
    if (t.allFinite()) result.poses[result.count++] = {R, t, true};
    return result;
  }
};

int main() {
  const Eigen::Matrix3d R = expSO3({0.02, -0.03, 0.1});
  const Eigen::Vector3d t(-0.8, 0.3, 0.05);
  const std::vector<Eigen::Vector3d> centers = {{0.0, 0.5, 0.0}, {0.0, -0.5, 0.0}};
  std::mt19937 random(1);
  std::uniform_real_distribution<double> share(-1.0, 1.0);
  std::vector<CorrespondenceSet::Entry> entries(200);
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector3d point(10 + 6 * share(random), 6 * share(random), 4 * share(random));
    const int camera1 = i % 2, camera2 = i / 2 % 2;
    Eigen::Vector3d seen = R * point + t - centers[camera2];
    if (i % 3 == 0) seen = Eigen::Vector3d(1.0, share(random), share(random));  // an outlier
    entries[i].rays = {makeRay((point - centers[camera1]).normalized(), centers[camera1]),
                       makeRay(seen.normalized(), centers[camera2]), camera1, camera2};
    entries[i].pixels_per_radian1 = entries[i].pixels_per_radian2 = 400.0;
  }
  const CorrespondenceSet set(entries, centers, centers);
  const RobustEstimate found = estimate<ThreePointRotation>(set, R, {}, {}, 1);
  std::printf("%d of 200 inliers, |t - truth| = %.1e m\n", found.inlier_count, (found.t - t).norm());
  return found.success && (found.t - t).norm() < 1e-3 ? 0 : 1;
}
