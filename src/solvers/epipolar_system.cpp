// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "epipolar_system.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "four_point_translation.h"
#include "sample_checks.h"

namespace multicam_egomotion {
namespace {

struct Lines {
  LaneVectors x, q;  // directions, moments
};

constexpr double kVanishing = 1e-14;    // determinant of rows of order 1
constexpr double kSameTilt = 1e-12;     // [rad]
constexpr double kMeeting = 1e-13;      // constraint of two rays through one point, relative to their moments
constexpr double kSmallestNorm = 1e-6;  // of a ray's direction
constexpr double kLargestNorm = 1e100;
constexpr double kLargestMoment = 1e100;  // [m]

// The correspondence that is not of the camera pair of the three others; -1: there is none.
int oddOne(const std::array<RayCorrespondence, 4>& sample) {
  const bool same01 = samePair(sample[0], sample[1]), same23 = samePair(sample[2], sample[3]);
  const bool same02 = samePair(sample[0], sample[2]), same13 = samePair(sample[1], sample[3]);
  if (same01 && same23 && same02) return -1;
  if (same01 && same02) return 3;
  if (same01 && same13) return 2;
  if (same23 && same02) return 1;
  if (same23 && same13) return 0;
  return -1;
}

Lines gather(const RayCorrespondence* const* sample, Ray RayCorrespondence::*ray) {
  const Ray &a = sample[0]->*ray, &b = sample[1]->*ray, &c = sample[2]->*ray, &d = sample[3]->*ray;
  Lines lines;
  for (int k = 0; k < 3; ++k) {
    lines.x[k] = Lanes(a.direction[k], b.direction[k], c.direction[k], d.direction[k]);
    lines.q[k] = Lanes(a.moment[k], b.moment[k], c.moment[k], d.moment[k]);
  }
  return lines;
}

Lanes squares(const LaneVectors& v) { return v[0] * v[0] + v[1] * v[1] + v[2] * v[2]; }

LaneVectors rotated(const Eigen::Matrix3d& R, const LaneVectors& v) {
  LaneVectors result;
  for (int k = 0; k < 3; ++k) result[k] = R(k, 0) * v[0] + R(k, 1) * v[1] + R(k, 2) * v[2];
  return result;
}

Lines rotated(const Eigen::Matrix3d& R, const Lines& lines) { return {rotated(R, lines.x), rotated(R, lines.q)}; }

// Makes the directions unit; false where one is zero or not finite.
bool normalize(Lines& lines) {
  constexpr double kUnit = 1e-13;
  const Lanes norms = squares(lines.x);
  if (!((norms > kSmallestNorm * kSmallestNorm).all() && (norms < kLargestNorm * kLargestNorm).all())) return false;
  if (((norms - 1).abs() < kUnit).all()) return true;
  const Lanes inverse = norms.sqrt().inverse();
  for (int k = 0; k < 3; ++k) {
    lines.x[k] *= inverse;
    lines.q[k] *= inverse;
  }
  return true;
}

LaneVectors gatherCenters(const RayCorrespondence* const* sample, int RayCorrespondence::*camera,
                          const Eigen::Vector3d* centers) {
  const Eigen::Vector3d &a = centers[sample[0]->*camera], &b = centers[sample[1]->*camera],
                        &c = centers[sample[2]->*camera], &d = centers[sample[3]->*camera];
  LaneVectors points;
  for (int k = 0; k < 3; ++k) points[k] = Lanes(a[k], b[k], c[k], d[k]);
  return points;
}

// Eight angles all round: halves at odd multiples of 11.25 degrees.
constexpr HalfAngle kHalfAngles[8] = {
    {0.55557023301960222, 0.83146961230254524},  {0.19509032201612827, -0.98078528040323045},
    {0.83146961230254524, -0.55557023301960222}, {0.98078528040323045, 0.19509032201612827},
    {0.55557023301960222, -0.83146961230254524}, {0.19509032201612827, 0.98078528040323045},
    {0.83146961230254524, 0.55557023301960222},  {0.98078528040323045, -0.19509032201612827}};

Eigen::Matrix4d rowsAt(const EpipolarSystem& system, const HalfAngle& half) {
  const double c = half.a * half.a - half.b * half.b, s = 2 * half.a * half.b;
  return c * system.c + (s * system.s + system.k);
}

// Cofactors of the normals of rows 0 to 2, as columns.
Eigen::Matrix3d normalCofactors(const Eigen::Matrix4d& rows) {
  const Eigen::Vector3d m0 = rows.row(0).head<3>(), m1 = rows.row(1).head<3>(), m2 = rows.row(2).head<3>();
  Eigen::Matrix3d cofactors;
  cofactors.col(0) = m1.cross(m2);
  cofactors.col(1) = m2.cross(m0);
  cofactors.col(2) = m0.cross(m1);
  return cofactors;
}

}  // namespace

bool onePair(const std::array<RayCorrespondence, 4>& sample) {
  return samePair(sample[0], sample[1]) && samePair(sample[0], sample[2]) && samePair(sample[0], sample[3]);
}

bool sameTilt(const VerticalPrior& prior) {
  const Eigen::Vector3d up = prior.R_aligned_body2 * prior.R_aligned_body1.row(2).transpose();
  return std::abs(up.x()) < kSameTilt && std::abs(up.y()) < kSameTilt && up.z() > 0;
}

LaneVectors cross(const LaneVectors& a, const LaneVectors& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

HalfAngle normalized(double a, double b) {
  const double inverse = 1.0 / std::sqrt(a * a + b * b);
  return {a * inverse, b * inverse};
}

SolverStatus buildEpipolarSystem(const std::array<RayCorrespondence, 4>& sample, const VerticalPrior& prior,
                                 const SolverOptions& options, EpipolarSystem& system) {
  if (!isRotation(prior.R_aligned_body1) || !isRotation(prior.R_aligned_body2) || !centersCover(sample, options)) {
    return SolverStatus::kInvalidInput;
  }
  const bool same_tilt = sameTilt(prior);
  system.R_aligned_body1 = same_tilt ? prior.R_aligned_body2 : prior.R_aligned_body1;
  system.R_aligned_body2 = prior.R_aligned_body2;

  const RayCorrespondence* ordered[4] = {&sample[0], &sample[1], &sample[2], &sample[3]};
  const int odd = oddOne(sample);
  system.three_and_one = odd >= 0;
  if (odd >= 0) std::swap(ordered[odd], ordered[3]);

  Lines first = gather(ordered, &RayCorrespondence::first), second = gather(ordered, &RayCorrespondence::second);
  if (!normalize(first) || !normalize(second)) return SolverStatus::kInvalidInput;
  first = rotated(system.R_aligned_body1, first);
  second = rotated(system.R_aligned_body2, second);
  const Lanes moments = squares(first.q) + squares(second.q);
  if (!(moments < kLargestMoment * kLargestMoment).all()) return SolverStatus::kInvalidInput;
  const double moment = std::sqrt(moments.maxCoeff());
  system.size = moment > 0 ? moment : 1.0;
  system.x1 = first.x;
  system.x2 = second.x;
  system.p1 = cross(first.x, first.q);
  system.p2 = cross(second.x, second.q);
  if (options.camera_centers != nullptr) {
    const Eigen::Vector3d* centers = options.camera_centers;
    system.p1 = rotated(system.R_aligned_body1, gatherCenters(ordered, &RayCorrespondence::camera1, centers));
    system.p2 = rotated(system.R_aligned_body2, gatherCenters(ordered, &RayCorrespondence::camera2, centers));
  }

  const Lanes &x1 = first.x[0], &y1 = first.x[1], &z1 = first.x[2];
  const Lanes &x2 = second.x[0], &y2 = second.x[1], &z2 = second.x[2];
  const Lanes &u1 = first.q[0], &v1 = first.q[1], &w1 = first.q[2];
  const Lanes &u2 = second.q[0], &v2 = second.q[1], &w2 = second.q[2];
  const double inverse_size = 1.0 / system.size;
  system.c.col(0) = y1 * z2;
  system.s.col(0) = x1 * z2;
  system.k.col(0) = -z1 * y2;
  system.c.col(1) = -x1 * z2;
  system.s.col(1) = y1 * z2;
  system.k.col(1) = z1 * x2;
  system.c.col(2) = x1 * y2 - y1 * x2;
  system.s.col(2) = -(x1 * x2 + y1 * y2);
  system.k.col(2).setZero();
  system.c.col(3) = (x2 * u1 + y2 * v1 + u2 * x1 + v2 * y1) * inverse_size;
  system.s.col(3) = (y2 * u1 - x2 * v1 + v2 * x1 - u2 * y1) * inverse_size;
  system.k.col(3) = (z2 * w1 + w2 * z1) * inverse_size;

  // R = I, t = 0 meets all constraints where both rays of every correspondence meet: intra-camera samples.
  system.identity_root = same_tilt && ((system.c.col(3) + system.k.col(3)).array().abs() <= kMeeting).all();
  if (system.identity_root) system.k.col(3) = -system.c.col(3);
  const bool central =
      samePair(sample[0], sample[1]) && samePair(sample[0], sample[2]) && samePair(sample[0], sample[3]);
  if (central) return SolverStatus::kCentral;
  const Eigen::Matrix<double, 4, 3> normals = (system.c + system.k).leftCols<3>();
  system.standing_still =
      system.identity_root && (normals.rowwise().squaredNorm().array() < kNoParallax * kNoParallax).all();
  return SolverStatus::kOk;
}

Eigen::Matrix4d cofactorMatrix(const Eigen::Matrix4d& m) {
  const auto a = m.col(0), b = m.col(1), c = m.col(2), d = m.col(3);
  // 2x2 minors of the first two and of the last two columns, by rows.
  const double s01 = a[0] * b[1] - a[1] * b[0], s02 = a[0] * b[2] - a[2] * b[0], s03 = a[0] * b[3] - a[3] * b[0];
  const double s12 = a[1] * b[2] - a[2] * b[1], s13 = a[1] * b[3] - a[3] * b[1], s23 = a[2] * b[3] - a[3] * b[2];
  const double c01 = c[0] * d[1] - c[1] * d[0], c02 = c[0] * d[2] - c[2] * d[0], c03 = c[0] * d[3] - c[3] * d[0];
  const double c12 = c[1] * d[2] - c[2] * d[1], c13 = c[1] * d[3] - c[3] * d[1], c23 = c[2] * d[3] - c[3] * d[2];
  Eigen::Matrix4d cofactors;
  double* out = cofactors.data();
  const auto column = [&out](const auto& v, double sign, double m01, double m02, double m03, double m12, double m13,
                             double m23) {
    out[0] = sign * (v[1] * m23 - v[2] * m13 + v[3] * m12);
    out[1] = sign * (v[2] * m03 - v[0] * m23 - v[3] * m02);
    out[2] = sign * (v[0] * m13 - v[1] * m03 + v[3] * m01);
    out[3] = sign * (v[1] * m02 - v[0] * m12 - v[2] * m01);
    out += 4;
  };
  column(b, 1.0, c01, c02, c03, c12, c13, c23);
  column(a, -1.0, c01, c02, c03, c12, c13, c23);
  column(d, 1.0, s01, s02, s03, s12, s13, s23);
  column(c, -1.0, s01, s02, s03, s12, s13, s23);
  return cofactors;
}

SystemAtAngle evaluate(const EpipolarSystem& system, const HalfAngle& half) {
  const double a = half.a, b = half.b;
  const double c = a * a - b * b, s = 2 * a * b;
  SystemAtAngle at;
  at.rows = c * system.c + (s * system.s + system.k);
  at.row_slopes = c * system.s - s * system.c;
  at.factor = 1;
  if (system.identity_root) {
    // sinθ B - (1 - cosθ) A = 2 b (a B - b A)
    at.factor = 2 * b;
    at.rows.col(3) = a * system.s.col(3) - b * system.c.col(3);
    at.row_slopes.col(3) = -0.5 * (b * system.s.col(3) + a * system.c.col(3));
  }
  if (system.three_and_one) {
    const Eigen::Matrix3d cofactors = normalCofactors(at.rows);
    at.value = at.rows.row(0).head<3>().dot(cofactors.col(0));
    at.slope = at.row_slopes.topLeftCorner<3, 3>().cwiseProduct(cofactors.transpose()).sum();
  } else {
    const Eigen::Matrix4d cofactors = cofactorMatrix(at.rows);
    at.value = at.rows.col(0).dot(cofactors.col(0));
    at.slope = at.row_slopes.cwiseProduct(cofactors).sum();
  }
  return at;
}

double roundingError(const EpipolarSystem& system, const SystemAtAngle& at) {
  const double cofactors =
      system.three_and_one ? normalCofactors(at.rows).cwiseAbs().sum() : cofactorMatrix(at.rows).cwiseAbs().sum();
  return 4 * std::numeric_limits<double>::epsilon() * cofactors;
}

bool vanishes(const EpipolarSystem& system) {
  bool all = true, normals = system.three_and_one;
  for (int i = 0; i < 8 && (all || normals); ++i) {
    const Eigen::Matrix4d rows = rowsAt(system, kHalfAngles[i]);
    all = all && !(std::abs(rows.determinant()) > kVanishing);
    normals = normals && !(std::abs(rows.topLeftCorner<3, 3>().determinant()) > kVanishing);
  }
  return all || normals;
}

HalfAngle farthestFromSingular(const EpipolarSystem& system) {
  HalfAngle farthest;
  double largest = -1;
  for (const HalfAngle& half : kHalfAngles) {
    const Eigen::Matrix4d rows = rowsAt(system, half);
    const double determinant =
        std::abs(system.three_and_one ? rows.topLeftCorner<3, 3>().determinant() : rows.determinant());
    if (determinant > largest) {
      largest = determinant;
      farthest = half;
    }
  }
  return farthest;
}

}  // namespace multicam_egomotion
