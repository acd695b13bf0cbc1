// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <random>

#include "multicam_egomotion/geometry/ray.h"
#include "multicam_egomotion/solvers/relative_pose.h"
#include "multicam_egomotion/solvers/solver_priors.h"

namespace multicam_egomotion {

/// Camera pairs of the four correspondences of a simulated sample.
enum class SampleKind { kIntra22, kIntra31, kIntra211, kIntra1111, kCross, kOnePair };
enum class Motion { kRandom, kForward, kSideways };

/// Noise-free minimal samples of a random rig with known motion.
struct SimulatedSample {
  std::array<RayCorrespondence, 4> rays;
  std::array<Eigen::Vector3d, 4> centers;  ///< camera centres in the body frame [m]
  Eigen::Matrix3d R;
  Eigen::Vector3d t;
  VerticalPrior vertical;
  AxisPrior axis;
};

class SampleSimulator {
 public:
  explicit SampleSimulator(unsigned seed) : random_(seed) {}

  double uniform(double lo, double hi) { return std::uniform_real_distribution<double>(lo, hi)(random_); }
  Eigen::Vector3d uniformVector(double size) {
    return {uniform(-size, size), uniform(-size, size), uniform(-size, size)};
  }
  Eigen::Vector3d direction() {
    std::normal_distribution<double> normal;
    return Eigen::Vector3d(normal(random_), normal(random_), normal(random_)).normalized();
  }

  /// Rotation about a random axis by an angle in [min_angle, max_angle] [rad], at most 3 m of translation.
  SimulatedSample sample(SampleKind kind, Motion motion, double min_angle, double max_angle) {
    SimulatedSample s;
    s.axis.axis = direction();
    const double angle = uniform(min_angle, max_angle) * (uniform(-1, 1) < 0 ? -1 : 1);
    s.R = Eigen::AngleAxisd(angle, s.axis.axis).toRotationMatrix();
    s.t = motion == Motion::kForward    ? Eigen::Vector3d(uniform(0.3, 3), 0, 0)
          : motion == Motion::kSideways ? Eigen::Vector3d(0, uniform(0.3, 3), 0)
                                        : Eigen::Vector3d(uniform(0.3, 3) * direction());
    observe(kind, s);
    return s;
  }

  /// Rays and priors of the motion already in `s`.
  void observe(SampleKind kind, SimulatedSample& s) {
    static constexpr int kPairs[6][4][2] = {{{0, 0}, {1, 1}, {0, 0}, {1, 1}}, {{0, 0}, {0, 0}, {1, 1}, {0, 0}},
                                            {{0, 0}, {1, 1}, {2, 2}, {0, 0}}, {{0, 0}, {1, 1}, {2, 2}, {3, 3}},
                                            {{0, 1}, {1, 0}, {1, 1}, {0, 1}}, {{0, 1}, {0, 1}, {0, 1}, {0, 1}}};
    s.centers[0] = uniformVector(0.5);
    s.centers[1] = s.centers[0] + direction();
    s.centers[2] = uniformVector(1);
    s.centers[3] = uniformVector(1);
    for (int i = 0; i < 4; ++i) {
      const int camera1 = kPairs[static_cast<int>(kind)][i][0], camera2 = kPairs[static_cast<int>(kind)][i][1];
      // Forward is x; a field of view of some 80 by 60 degrees, points 4 to 20 m away.
      const Eigen::Vector3d bearing = Eigen::Vector3d(1, uniform(-0.8, 0.8), uniform(-0.6, 0.6)).normalized();
      const Eigen::Vector3d point = s.centers[camera1] + uniform(4, 20) * bearing;
      s.rays[i].first = makeRay(bearing, s.centers[camera1]);
      s.rays[i].second = makeRay((s.R * point + s.t - s.centers[camera2]).normalized(), s.centers[camera2]);
      s.rays[i].camera1 = camera1;
      s.rays[i].camera2 = camera2;
    }
    // Up within 30 degrees of body z.
    const Eigen::Vector3d up = Eigen::Vector3d(uniform(-0.5, 0.5), uniform(-0.5, 0.5), 1).normalized();
    s.vertical = verticalPriorFromUp(up, s.R * up);
  }

 private:
  std::mt19937 random_;
};

/// Angle between two rotations [rad], exact for small ones.
inline double rotationError(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b) {
  return 2 * std::asin(std::min(1.0, (a - b).norm() / (2 * std::sqrt(2.0))));
}

/// Angle between two directions [rad].
inline double directionError(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

}  // namespace multicam_egomotion
