// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "multicam_egomotion/estimation/correspondence_set.h"
#include "paper_experiments/paper_solver.h"

namespace multicam_egomotion {

enum class TwoCameraMotion { kForward, kRandom, kSideways };
constexpr std::array<TwoCameraMotion, 3> kTwoCameraMotions = {TwoCameraMotion::kForward, TwoCameraMotion::kRandom,
                                                              TwoCameraMotion::kSideways};
std::string name(TwoCameraMotion motion);

/// How the axis prior is wrong when the vertical is.
enum class AxisNoise {
  kEquivalent,  ///< axis of R_imu2ᵀ R_v2v1 R_imu1 with the noisy R_imu1, R_imu2
  kTurned,      ///< δR v, with the δR by which the noisy R_imu1 is wrong
};

/// Standard deviations.
struct NoiseLevel {
  double image_px = 0.0;
  double pitch = 0.0, roll = 0.0;  ///< of the alignment at t1 and, independently, at t2 [rad]
};

/// One trial of the paper's section V-B: two cameras 1 m apart that look ahead, f = 400 px, centre (320, 240), at most
/// 3 m of translation, Euler angles of the rotation within 10 degrees, points that both cameras see at both times,
/// intra-camera correspondences. The paper leaves open: image size (640x480), depths (5 to 20 m), attitude at t1 (pitch
/// and roll within 10 degrees). Body axes as in REP-103; pitch turns about y, roll about x.
/// The noise is drawn once, in units of its standard deviation: it is the same for all solvers and levels.
class TwoCameraTrial {
 public:
  static constexpr int kFurther = 20;  ///< correspondences that the solvers do not see

  TwoCameraTrial(TwoCameraMotion motion, std::uint64_t seed, std::uint64_t trial);

  const Eigen::Matrix3d& R() const { return R_; }  ///< R_f2_f1
  const Eigen::Vector3d& t() const { return t_; }  ///< [m]

  /// The first correspondences are those of cameras 0, 1, 0, 1, 0: a 2+2 sample for four, 3+2 for five.
  SolverProblem problem(const NoiseLevel& noise, AxisNoise axis_noise) const;
  /// The further ones.
  CorrespondenceSet further(const NoiseLevel& noise) const;

 private:
  RayCorrespondence rays(int index, double image_px) const;

  Eigen::Matrix3d R_;
  Eigen::Vector3d t_;
  double pitch_[2], roll_[2];
  Eigen::Matrix3d R_v2_v1_;
  double pitch_noise_[2], roll_noise_[2];
  struct Observation {
    Eigen::Vector2d pixel[2], noise[2];  // at t1 and t2
  };
  std::array<Observation, kLargestSample + kFurther> observations_;
};

}  // namespace multicam_egomotion
