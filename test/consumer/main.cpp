// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Uses the installed library as another project would: solves one minimal sample, estimates one pose robustly from
// pixels, and fails where either is wrong.
#include <multicam_egomotion/estimation/minimal_solvers.h>
#include <multicam_egomotion/estimation/pixel_correspondences.h>
#include <multicam_egomotion/estimation/robust_estimator.h>
#include <multicam_egomotion/geometry/so3.h>

#include <algorithm>
#include <cstdio>
#include <random>
#include <vector>

namespace me = multicam_egomotion;

// Two cameras 1 m apart that look along body x.
me::CameraRig makeRig() {
  const me::CameraModel model(640, 480, 400, 400, 320, 240, me::Distortion::kNone, {});
  Eigen::Isometry3d T_body_cam = Eigen::Isometry3d::Identity();
  T_body_cam.linear() << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  std::vector<me::RigCamera> cameras;
  for (const double y : {0.5, -0.5}) {
    T_body_cam.translation() << 0.0, y, 0.0;
    cameras.push_back({"camera", "camera", model, T_body_cam});
  }
  return me::CameraRig(cameras);
}

int main() {
  const me::CameraRig rig = makeRig();
  const Eigen::Matrix3d R = me::expSO3({0.02, -0.03, 0.1});  // T_f2_f1
  const Eigen::Vector3d t(-0.8, 0.3, 0.05);
  const me::VerticalPrior vertical = me::verticalPriorFromUp(Eigen::Vector3d::UnitZ(), R * Eigen::Vector3d::UnitZ());

  std::mt19937 random(1);
  std::uniform_real_distribution<double> share(-1.0, 1.0);
  std::vector<me::PixelCorrespondence> pixels;
  while (pixels.size() < 200) {
    const Eigen::Vector3d point(10.0 + 6.0 * share(random), 6.0 * share(random), 4.0 * share(random));
    me::PixelCorrespondence seen;
    seen.camera1 = static_cast<int>(pixels.size() % 2);
    seen.camera2 = static_cast<int>(pixels.size() / 2 % 2);
    const me::RigCamera &first = rig.camera(seen.camera1), &second = rig.camera(seen.camera2);
    if (first.model.project(first.T_body_cam.inverse() * point, &seen.pixel1) && first.model.contains(seen.pixel1) &&
        second.model.project(second.T_body_cam.inverse() * (R * point + t), &seen.pixel2) &&
        second.model.contains(seen.pixel2)) {
      pixels.push_back(seen);
    }
  }

  const me::PixelCorrespondenceSet all = me::correspondencesFromPixels(rig, pixels);
  const auto candidates =
      me::solveFourPointVertical({all.set.rays(0), all.set.rays(1), all.set.rays(2), all.set.rays(3)}, vertical);
  const bool solved = std::any_of(candidates.begin(), candidates.end(), [&](const me::RelativePose& pose) {
    return (pose.R - R).norm() < 1e-9 && (pose.t - t).norm() < 1e-7;
  });

  const me::RobustEstimate estimate = me::estimate<me::FourPointVertical>(all.set, vertical, {}, {}, 1);
  const bool estimated = estimate.success && (estimate.R - R).norm() < 1e-6 && (estimate.t - t).norm() < 1e-4;

  std::printf("minimal solver: %d poses, truth %s; estimator: %d of %d inliers, %s\n", candidates.size(),
              solved ? "found" : "MISSED", estimate.inlier_count, all.set.size(), estimated ? "right" : "WRONG");
  return solved && estimated ? 0 : 1;
}
