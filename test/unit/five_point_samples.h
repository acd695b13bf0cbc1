// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <array>

#include "solver_samples.h"

namespace multicam_egomotion {

/// Camera pairs of the five correspondences of a simulated sample.
using CameraPairs = std::array<std::array<int, 2>, 5>;
constexpr CameraPairs kIntra32 = {{{0, 0}, {1, 1}, {0, 0}, {1, 1}, {0, 0}}};
constexpr CameraPairs kIntra221 = {{{0, 0}, {1, 1}, {2, 2}, {0, 0}, {1, 1}}};
constexpr CameraPairs kIntra2111 = {{{0, 0}, {1, 1}, {2, 2}, {3, 3}, {0, 0}}};
constexpr CameraPairs kMixed = {{{0, 0}, {1, 1}, {0, 1}, {0, 0}, {1, 0}}};
constexpr CameraPairs kCross2 = {{{0, 1}, {1, 0}, {0, 1}, {1, 0}, {0, 1}}};
constexpr CameraPairs kCross4 = {{{0, 1}, {1, 2}, {2, 3}, {3, 0}, {0, 2}}};

struct FivePointKind {
  const char* name;
  CameraPairs pairs;
};
constexpr FivePointKind kFivePointKinds[] = {{"intra_3_2", kIntra32},       {"intra_2_2_1", kIntra221},
                                             {"intra_2_1_1_1", kIntra2111}, {"mixed", kMixed},
                                             {"cross_2", kCross2},          {"cross_4", kCross4}};

/// A noise-free sample for the solver with known rotation angle.
struct FivePointSample {
  std::array<RayCorrespondence, 5> rays;
  std::array<Eigen::Vector3d, 4> centers;  ///< camera centres in the body frame [m]
  Eigen::Matrix3d R;
  Eigen::Vector3d t;
  AnglePrior prior;
};

/// Rays of the motion (R, t) already in `s`; rig and points as in SampleSimulator.
inline void observe(SampleSimulator& simulator, const CameraPairs& pairs, FivePointSample& s) {
  s.centers[0] = simulator.uniformVector(0.5);
  s.centers[1] = s.centers[0] + simulator.direction();
  s.centers[2] = simulator.uniformVector(1);
  s.centers[3] = simulator.uniformVector(1);
  for (int i = 0; i < 5; ++i) {
    const int camera1 = pairs[i][0], camera2 = pairs[i][1];
    const Eigen::Vector3d bearing =
        Eigen::Vector3d(1, simulator.uniform(-0.8, 0.8), simulator.uniform(-0.6, 0.6)).normalized();
    const Eigen::Vector3d point = s.centers[camera1] + simulator.uniform(4, 20) * bearing;
    s.rays[i].first = makeRay(bearing, s.centers[camera1]);
    s.rays[i].second = makeRay((s.R * point + s.t - s.centers[camera2]).normalized(), s.centers[camera2]);
    s.rays[i].camera1 = camera1;
    s.rays[i].camera2 = camera2;
  }
}

/// Rotation about a random axis by an angle in [min_angle, max_angle] [rad], 0.3 to 3 m of translation.
inline FivePointSample fivePointSample(SampleSimulator& simulator, const CameraPairs& pairs, Motion motion,
                                       double min_angle, double max_angle) {
  FivePointSample s;
  s.prior.angle = simulator.uniform(min_angle, max_angle);
  s.R = Eigen::AngleAxisd(s.prior.angle, simulator.direction()).toRotationMatrix();
  s.t = motion == Motion::kForward    ? Eigen::Vector3d(simulator.uniform(0.3, 3), 0, 0)
        : motion == Motion::kSideways ? Eigen::Vector3d(0, simulator.uniform(0.3, 3), 0)
                                      : Eigen::Vector3d(simulator.uniform(0.3, 3) * simulator.direction());
  observe(simulator, pairs, s);
  return s;
}

}  // namespace multicam_egomotion
