// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "multicam_egomotion/geometry/camera_model.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <sstream>
#include <stdexcept>

namespace multicam_egomotion {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr int kMaxIterations = 30;
// Newton converges quadratically: the error after a step this small is below machine precision.
constexpr double kLastStep = 1e-9;

using Coefficients = std::array<double, 8>;

// r -> r radial(r) of radtan and rational_polynomial, as radial(r^2) and its derivative by r^2.
struct Radial {
  double value, derivative;
};

inline Radial radialFactor(const Coefficients& k, double s) {
  const double numerator = 1 + s * (k[0] + s * (k[1] + s * k[4]));
  const double numerator_ds = k[0] + s * (2 * k[1] + s * 3 * k[4]);
  const double denominator = 1 + s * (k[5] + s * (k[6] + s * k[7]));
  const double denominator_ds = k[5] + s * (2 * k[6] + s * 3 * k[7]);
  const double inverse = 1 / denominator;
  const double value = numerator * inverse;
  return {value, (numerator_ds - value * denominator_ds) * inverse};
}

// Distorted normalized coordinates of (x, y) with Jacobian; false outside the range where the map is one to one.
inline bool distort(const Coefficients& k, double max_radius, const Eigen::Vector2d& p, Eigen::Vector2d* distorted,
                    Eigen::Matrix2d* jacobian) {
  const double x = p.x(), y = p.y(), s = x * x + y * y;
  if (!(s <= max_radius * max_radius)) return false;
  const Radial radial = radialFactor(k, s);
  const double p1 = k[2], p2 = k[3];
  *distorted << x * radial.value + 2 * p1 * x * y + p2 * (s + 2 * x * x),
      y * radial.value + p1 * (s + 2 * y * y) + 2 * p2 * x * y;
  const double cross = 2 * x * y * radial.derivative + 2 * p1 * x + 2 * p2 * y;
  *jacobian << radial.value + 2 * x * x * radial.derivative + 2 * p1 * y + 6 * p2 * x, cross, cross,
      radial.value + 2 * y * y * radial.derivative + 6 * p1 * y + 2 * p2 * x;
  return jacobian->determinant() > 0;
}

// Damped Newton from the distorted point: one to one maps of a lens keep it within the range.
bool undistort(const Coefficients& k, double max_radius, const Eigen::Vector2d& target, Eigen::Vector2d* p,
               Eigen::Matrix2d* jacobian) {
  Eigen::Vector2d value;
  *p = target;
  // A strong pincushion (or a far outlier) can start outside the range: pull the start back to its middle.
  if (!distort(k, max_radius, *p, &value, jacobian)) {
    *p *= 0.5 * std::min(1.0, max_radius / target.norm());
    if (!distort(k, max_radius, *p, &value, jacobian)) return false;
  }
  Eigen::Vector2d error = target - value;
  for (int i = 0; i < kMaxIterations; ++i) {
    Eigen::Vector2d step = jacobian->inverse() * error;
    const double size = step.norm() / (1 + p->norm());
    bool accepted = false;
    for (int halving = 0; halving < 12 && !accepted; ++halving, step *= 0.5) {
      const Eigen::Vector2d candidate = *p + step;
      Eigen::Matrix2d candidate_jacobian;
      if (!distort(k, max_radius, candidate, &value, &candidate_jacobian)) continue;
      const Eigen::Vector2d candidate_error = target - value;
      if (size > kLastStep && !(candidate_error.squaredNorm() < error.squaredNorm())) continue;
      *p = candidate;
      *jacobian = candidate_jacobian;
      error = candidate_error;
      accepted = true;
    }
    if (!accepted) return false;
    if (size <= kLastStep) return true;
  }
  return false;
}

struct Angle {
  double value, derivative;
};

// Distorted angle of the equidistant model and its derivative.
inline Angle distortAngle(const Coefficients& k, double theta) {
  const double t = theta * theta;
  return {theta * (1 + t * (k[0] + t * (k[1] + t * (k[2] + t * k[3])))),
          1 + t * (3 * k[0] + t * (5 * k[1] + t * (7 * k[2] + t * 9 * k[3])))};
}

// Newton, bisecting whenever it leaves the bracket.
bool undistortAngle(const Coefficients& k, double max_theta, double distorted, double* theta, double* derivative) {
  const double at_max = distortAngle(k, max_theta).value;
  if (!(distorted <= at_max)) return false;
  double low = 0, high = max_theta;
  *theta = std::min(distorted, max_theta);
  for (int i = 0; i < 100; ++i) {
    const Angle angle = distortAngle(k, *theta);
    *derivative = angle.derivative;
    const double error = distorted - angle.value;
    (error > 0 ? low : high) = *theta;
    double next = *theta + error / angle.derivative;
    if (!(next >= low && next <= high)) next = 0.5 * (low + high);
    const double size = std::abs(next - *theta);
    *theta = next;
    if (size <= kLastStep) break;
  }
  *derivative = distortAngle(k, *theta).derivative;
  return *derivative > 0;
}

// End of the first interval [0, end] where `increasing` holds, no more than `limit`; scanned, then bisected.
double monotonicRange(double limit, const std::function<bool(double)>& increasing) {
  constexpr int kSteps = 4000;
  double low = 0;
  for (int i = 1; i <= kSteps; ++i) {
    double high = limit * i / kSteps;
    if (increasing(high)) {
      low = high;
      continue;
    }
    for (int bisection = 0; bisection < 60; ++bisection) {
      const double middle = 0.5 * (low + high);
      (increasing(middle) ? low : high) = middle;
    }
    return low;
  }
  return limit;
}

double validRange(Distortion distortion, const Coefficients& k) {
  if (distortion == Distortion::kNone) return std::numeric_limits<double>::infinity();
  if (distortion == Distortion::kEquidistant) {
    return monotonicRange(kPi, [&k](double theta) { return distortAngle(k, theta).derivative > 0; });
  }
  // Scanned in the angle, to be as fine in the centre as far out.
  const double widest = 89.9 * kPi / 180;
  const double angle = monotonicRange(widest, [&k](double a) {
    const double s = std::tan(a) * std::tan(a);
    if (1 + s * (k[5] + s * (k[6] + s * k[7])) <= 0) return false;
    const Radial radial = radialFactor(k, s);
    return radial.value + 2 * s * radial.derivative > 0;
  });
  return std::tan(angle);
}

template <typename T>
[[noreturn]] void refuse(const std::string& name, const T& found, const std::string& expected) {
  std::ostringstream text;
  text << "camera model: " << name << " is " << found << ", expected " << expected;
  throw std::invalid_argument(text.str());
}

std::size_t maxCoefficients(Distortion distortion) {
  switch (distortion) {
    case Distortion::kNone:
      return 0;
    case Distortion::kRadtan:
      return 5;
    case Distortion::kRationalPolynomial:
      return 8;
    case Distortion::kEquidistant:
      return 4;
  }
  refuse("distortion", static_cast<int>(distortion), "one of the four models");
}

}  // namespace

CameraModel::CameraModel(int width, int height, double fx, double fy, double cx, double cy, Distortion distortion,
                         const std::vector<double>& coefficients)
    : width_(width),
      height_(height),
      fx_(fx),
      fy_(fy),
      cx_(cx),
      cy_(cy),
      distortion_(distortion),
      coefficients_(coefficients) {
  if (width < 1) refuse("width", width, "at least 1 px");
  if (height < 1) refuse("height", height, "at least 1 px");
  if (!std::isfinite(fx) || fx <= 0) refuse("fx", fx, "a positive focal length [px]");
  if (!std::isfinite(fy) || fy <= 0) refuse("fy", fy, "a positive focal length [px]");
  if (!std::isfinite(cx)) refuse("cx", cx, "a finite principal point [px]");
  if (!std::isfinite(cy)) refuse("cy", cy, "a finite principal point [px]");
  const std::size_t most = maxCoefficients(distortion);
  for (std::size_t i = 0; i < coefficients.size(); ++i) {
    if (!std::isfinite(coefficients[i])) {
      refuse("distortion coefficient " + std::to_string(i), coefficients[i], "a finite number");
    }
    if (i >= most && coefficients[i] != 0) {
      refuse("number of distortion coefficients", coefficients.size(),
             "at most " + std::to_string(most) + " for this distortion model");
    }
  }
  coefficients_.resize(std::min(coefficients_.size(), most));
  std::copy(coefficients_.begin(), coefficients_.end(), k_.begin());

  max_radius_ = validRange(distortion_, k_);
  if (distortion_ != Distortion::kNone) {
    // A lens is one to one over its picture; a range that ends near the centre means swapped or foreign coefficients.
    const double distorted = distortion_ == Distortion::kEquidistant
                                 ? distortAngle(k_, max_radius_).value
                                 : max_radius_ * radialFactor(k_, max_radius_ * max_radius_).value;
    const double range_px = focalLength() * distorted, least_px = std::min(width, height) / 8.0;
    if (!(range_px >= least_px)) {
      std::ostringstream expected;
      expected << "at least " << least_px << " px (check order and model of the coefficients)";
      refuse("range around the principal point where the distortion can be inverted [px]", range_px, expected.str());
    }
  }
}

double CameraModel::focalLength() const { return std::sqrt(fx_ * fy_); }

bool CameraModel::contains(const Eigen::Vector2d& pixel, double border_px) const {
  return pixel.x() >= border_px && pixel.y() >= border_px && pixel.x() <= width_ - 1 - border_px &&
         pixel.y() <= height_ - 1 - border_px;
}

bool CameraModel::unproject(const Eigen::Vector2d& pixel, Eigen::Vector3d* bearing,
                            Eigen::Matrix<double, 3, 2>* d_bearing_d_pixel) const {
  const Eigen::Vector2d distorted((pixel.x() - cx_) / fx_, (pixel.y() - cy_) / fy_);
  if (!distorted.allFinite()) return false;

  if (distortion_ == Distortion::kEquidistant) {
    const double radius = distorted.norm();
    double theta, derivative;
    if (!undistortAngle(k_, max_radius_, radius, &theta, &derivative)) return false;
    const Eigen::Vector2d e = radius > 1e-12 ? Eigen::Vector2d(distorted / radius) : Eigen::Vector2d::UnitX();
    const double sine = std::sin(theta), cosine = std::cos(theta);
    *bearing << sine * e.x(), sine * e.y(), cosine;
    if (d_bearing_d_pixel) {
      const double across = radius > 1e-12 ? sine / radius : 1.0;
      const Eigen::Vector2d n(-e.y(), e.x());
      Eigen::Matrix<double, 3, 2> d;
      d.topRows<2>() = (cosine / derivative) * e * e.transpose() + across * n * n.transpose();
      d.row(2) = (-sine / derivative) * e.transpose();
      d.col(0) /= fx_;
      d.col(1) /= fy_;
      *d_bearing_d_pixel = d;
    }
    return true;
  }

  Eigen::Vector2d p = distorted;
  Eigen::Matrix2d jacobian = Eigen::Matrix2d::Identity();
  if (distortion_ != Distortion::kNone && !undistort(k_, max_radius_, distorted, &p, &jacobian)) return false;
  const double inverse_norm = 1 / std::sqrt(p.squaredNorm() + 1);
  *bearing << p.x() * inverse_norm, p.y() * inverse_norm, inverse_norm;
  if (d_bearing_d_pixel) {
    Eigen::Matrix<double, 3, 2> d_bearing_d_p = -*bearing * bearing->head<2>().transpose() * inverse_norm;
    d_bearing_d_p(0, 0) += inverse_norm;
    d_bearing_d_p(1, 1) += inverse_norm;
    Eigen::Matrix2d d_p_d_pixel = jacobian.inverse();
    d_p_d_pixel.col(0) /= fx_;
    d_p_d_pixel.col(1) /= fy_;
    *d_bearing_d_pixel = d_bearing_d_p * d_p_d_pixel;
  }
  return true;
}

bool CameraModel::project(const Eigen::Vector3d& point, Eigen::Vector2d* pixel,
                          Eigen::Matrix<double, 2, 3>* d_pixel_d_point) const {
  if (distortion_ == Distortion::kEquidistant) {
    const double radius = point.head<2>().norm(), z = point.z();
    const double square = radius * radius + z * z;
    const double theta = std::atan2(radius, z);
    if (!(square > 0) || !std::isfinite(square) || !(theta <= max_radius_)) return false;
    const bool on_axis = radius <= 1e-12 * std::abs(z);
    if (on_axis && z < 0) return false;
    const Angle angle = distortAngle(k_, theta);
    const Eigen::Vector2d e = on_axis ? Eigen::Vector2d::UnitX() : Eigen::Vector2d(point.head<2>() / radius);
    *pixel << fx_ * angle.value * e.x() + cx_, fy_ * angle.value * e.y() + cy_;
    if (d_pixel_d_point) {
      const double across = on_axis ? 1 / z : angle.value / radius;
      const Eigen::Vector2d n(-e.y(), e.x());
      Eigen::Matrix<double, 2, 3> d;
      d.leftCols<2>() = (angle.derivative * z / square) * e * e.transpose() + across * n * n.transpose();
      d.col(2) = (-angle.derivative * radius / square) * e;
      d.row(0) *= fx_;
      d.row(1) *= fy_;
      *d_pixel_d_point = d;
    }
    return true;
  }

  if (!(point.z() > 0)) return false;
  const double inverse_z = 1 / point.z();
  const Eigen::Vector2d p = point.head<2>() * inverse_z;
  if (!p.allFinite()) return false;
  Eigen::Vector2d distorted = p;
  Eigen::Matrix2d jacobian = Eigen::Matrix2d::Identity();
  if (distortion_ != Distortion::kNone && !distort(k_, max_radius_, p, &distorted, &jacobian)) return false;
  *pixel << fx_ * distorted.x() + cx_, fy_ * distorted.y() + cy_;
  if (d_pixel_d_point) {
    Eigen::Matrix<double, 2, 3> d;
    d.leftCols<2>() = jacobian * inverse_z;
    d.col(2) = -jacobian * p * inverse_z;
    d.row(0) *= fx_;
    d.row(1) *= fy_;
    *d_pixel_d_point = d;
  }
  return true;
}

Distortion distortionFromName(const std::string& name) {
  if (name == "none") return Distortion::kNone;
  if (name == "radtan" || name == "plumb_bob") return Distortion::kRadtan;
  if (name == "rational_polynomial") return Distortion::kRationalPolynomial;
  if (name == "equidistant" || name == "fisheye") return Distortion::kEquidistant;
  refuse("distortion model", "'" + name + "'",
         "none, radtan (plumb_bob), rational_polynomial or equidistant (fisheye)");
}

}  // namespace multicam_egomotion
