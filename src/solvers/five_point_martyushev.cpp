// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "multicam_egomotion/solvers/five_point_martyushev.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

#include "five_point_martyushev_axes.h"
#include "five_point_martyushev_system.h"
#include "four_point_translation.h"
#include "sample_checks.h"

namespace multicam_egomotion {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kNoAngle = 1e-12;            // [rad]
constexpr double kSmallAngle = 0.01;          // [rad]; below it the limit of small angles adds its axes
constexpr double kNearHalfTurn = 1e-4;        // [rad]
constexpr double kLimitAlone = 1e-4;          // angle over the second singular value
constexpr double kSameAxis = 1e-8;            // [rad]
constexpr double kMeetInCenter = 1e-8;        // relative to rig and translation
constexpr double kLargestTranslation = 1e14;  // relative to the rig

using Sample = std::array<RayCorrespondence, 5>;

/// Where the rays of three correspondences of one camera pair meet at t1 and at t2.
struct TripleCenters {
  bool exist = false;
  Eigen::Vector3d c1, c2;
};

/// The point with the smallest moments about it; false for parallel rays.
bool meetingPoint(const Ray* const* rays, Eigen::Vector3d& point) {
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector3d& x = rays[i]->direction;
    normal += x.squaredNorm() * Eigen::Matrix3d::Identity() - x * x.transpose();
    right += x.cross(rays[i]->moment);
  }
  const Eigen::ColPivHouseholderQR<Eigen::Matrix3d> qr(normal);
  if (!qr.isInvertible()) return false;
  point = qr.solve(right);
  return true;
}

/// Size of the largest group of one camera pair; centres of a group of three.
int largestGroup(const Sample& sample, TripleCenters& centers) {
  int largest = 1;
  for (const RayCorrespondence& first : sample) {
    const Ray *rays1[5], *rays2[5];
    int count = 0;
    for (const RayCorrespondence& ray : sample) {
      if (!samePair(first, ray)) continue;
      rays1[count] = &ray.first;
      rays2[count++] = &ray.second;
    }
    if (count <= largest) continue;
    largest = count;
    if (count == 3) centers.exist = meetingPoint(rays1, centers.c1) && meetingPoint(rays2, centers.c2);
  }
  return largest;
}

/// Number of the ten depths that are positive; `direction_only`: at the scale at which the camera centres coincide.
int positiveDepths(const Sample& sample, const RelativePose& pose, const SolverOptions& options, bool direction_only) {
  constexpr double kTolerance = -1e-14;  // a point without parallax lies at infinity, where rounding decides the sign
  int positive = 0;
  for (const RayCorrespondence& ray : sample) {
    Eigen::Vector3d d = pose.t;
    if (!direction_only) {
      const bool known = options.camera_centers != nullptr;
      const Ray &first = ray.first, &second = ray.second;
      d += pose.R * (known ? options.camera_centers[ray.camera1] : first.direction.cross(first.moment));
      d -= known ? options.camera_centers[ray.camera2] : second.direction.cross(second.moment);
    }
    const Eigen::Vector3d a = pose.R * ray.first.direction, &b = ray.second.direction, n = a.cross(b);
    positive += (b.cross(d).dot(n) > kTolerance) + (a.cross(d).dot(n) > kTolerance);
  }
  return positive;
}

/// Normals and constants of the five constraints on t, normals of unit length; rows without parallax are zero.
Eigen::Matrix<double, 5, 4> constraintsOnTranslation(const Sample& sample, const Eigen::Matrix3d& R, double size) {
  Eigen::Matrix<double, 5, 4> rows = Eigen::Matrix<double, 5, 4>::Zero();
  for (int i = 0; i < 5; ++i) {
    const Eigen::Vector3d x = R * sample[i].first.direction, &x2 = sample[i].second.direction, m = x.cross(x2);
    if (!(m.norm() > kNoParallax * x.norm() * x2.norm())) continue;
    rows.row(i) << m.transpose(), (x.dot(sample[i].second.moment) + x2.dot(R * sample[i].first.moment)) / size;
    rows.row(i) /= m.norm();
  }
  return rows;
}

/// The pose of a solution. False where not even the direction of t is determined, or t is infinite.
bool toPose(const Sample& sample, const AxisSystem& system, const AxisSystem::Solution& solution,
            const SolverOptions& options, double size, RelativePose& pose) {
  pose.R = system.rotation(solution.axis);
  const Eigen::Matrix<double, 5, 4> rows = constraintsOnTranslation(sample, pose.R, size);
  const Eigen::ColPivHouseholderQR<Eigen::Matrix<double, 5, 4>> qr(rows);
  const auto diagonal = qr.matrixQR().diagonal().cwiseAbs();
  pose.scale_observable = diagonal(2) > kScaleTolerance * diagonal(0);
  if (pose.scale_observable) {
    const Eigen::Vector4d t = system.translation(solution.v);
    pose.t = t.head<3>() / t(3);
    return pose.t.norm() < kLargestTranslation * size;
  }
  const Eigen::JacobiSVD<Eigen::Matrix<double, 5, 3>, Eigen::FullPivHouseholderQRPreconditioner> normals(
      rows.leftCols<3>(), Eigen::ComputeFullU | Eigen::ComputeFullV);
  if (normals.singularValues()(1) <= kScaleTolerance * normals.singularValues()(0)) return false;
  pose.t = normals.matrixV().col(2);
  if (positiveDepths(sample, pose, options, true) < 5) pose.t = -pose.t;
  return true;
}

bool validInput(const Sample& sample, const AnglePrior& prior, const SolverOptions& options) {
  constexpr double kLargest = 1e100;
  if (!std::isfinite(prior.angle)) return false;
  for (const RayCorrespondence& ray : sample) {
    for (const Ray* side : {&ray.first, &ray.second}) {
      const double direction = side->direction.squaredNorm(), moment = side->moment.squaredNorm();
      if (!(direction > 1 / kLargest && direction < kLargest && moment < kLargest)) return false;
    }
  }
  return centersCover(sample, options);
}

/// Solutions found so far, as axes and as poses.
class SolutionSet {
 public:
  SolutionSet(const Sample& sample, const AxisSystem& system, const SolverOptions& options,
              const TripleCenters& centers, double size, PoseCandidates<44>& candidates)
      : sample_(sample), system_(system), options_(options), centers_(centers), size_(size), candidates_(candidates) {}

  /// False if it is known already.
  bool add(const AxisSystem::Solution& solution) {
    // At half a turn n and -n are one rotation.
    const double half_turn = kPi - system_.angle();
    for (int i = 0; i < count_; ++i) {
      if ((axes_[i] - solution.axis).norm() < kSameAxis) return false;
      if (half_turn < kSameAxis && (axes_[i] + solution.axis).norm() < kSameAxis) return false;
    }
    if (count_ == kCapacity) return false;
    axes_[count_++] = solution.axis;

    RelativePose& pose = candidates_.poses[candidates_.count];
    if (!toPose(sample_, system_, solution, options_, size_, pose)) return true;
    if (centers_.exist && pose.scale_observable &&
        (pose.R * centers_.c1 + pose.t - centers_.c2).norm() < kMeetInCenter * (size_ + pose.t.norm())) {
      return true;
    }
    if (options_.positive_depths_only && positiveDepths(sample_, pose, options_, !pose.scale_observable) < 10) {
      return true;
    }
    ++candidates_.count;
    return true;
  }

 private:
  static constexpr int kCapacity = PoseCandidates<44>::kCapacity;

  const Sample& sample_;
  const AxisSystem& system_;
  const SolverOptions& options_;
  const TripleCenters& centers_;
  double size_;
  PoseCandidates<44>& candidates_;
  std::array<Eigen::Vector3d, kCapacity> axes_;
  int count_ = 0;
};

}  // namespace

PoseCandidates<44> solveFivePointMartyushev(const Sample& sample, const AnglePrior& prior,
                                            const SolverOptions& options) {
  PoseCandidates<44> candidates;
  const auto stop = [&candidates](SolverStatus status) {
    candidates.status = status;
    return candidates;
  };
  if (!validInput(sample, prior, options)) return stop(SolverStatus::kInvalidInput);
  const double angle = std::abs(std::remainder(prior.angle, 2 * kPi));
  if (angle < kNoAngle) return stop(SolverStatus::kAxisUndefined);
  TripleCenters centers;
  if (largestGroup(sample, centers) > 3) return stop(SolverStatus::kCentral);

  Sample unit = sample;
  double size = 0;
  for (RayCorrespondence& ray : unit) {
    for (Ray* side : {&ray.first, &ray.second}) {
      const double length = side->direction.norm();
      side->direction /= length;
      side->moment /= length;
      size = std::max(size, side->moment.norm());
    }
  }
  if (!(size > 0)) return stop(SolverStatus::kCentral);
  const AxisSystem system(unit, angle);
  if (!system.finite()) return stop(SolverStatus::kInvalidInput);

  ApproximateAxes starts;
  const bool limit_alone = angle < kLimitAlone * system.singularValues()(1);
  // At half a turn n and -n are both solutions and the pencil is singular: it is taken a little before.
  const double pencil_angle = std::min(angle, kPi - kNearHalfTurn);
  if (!pencilAxes(pencil_angle < angle ? AxisSystem(unit, pencil_angle) : system, !limit_alone, starts)) {
    return stop(SolverStatus::kCentral);
  }
  if (angle < kSmallAngle) smallAngleAxes(system, starts);

  SolutionSet solutions(unit, system, options, centers, size, candidates);
  for (int i = 0; i < starts.count; ++i) {
    AxisSystem::Solution solution = system.start(starts.axes[i]), other;
    if (!system.refine(solution) || !solutions.add(solution)) continue;
    if (system.companion(solution, other) && system.refine(other)) solutions.add(other);
  }
  return candidates;
}

}  // namespace multicam_egomotion
