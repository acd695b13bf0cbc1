// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

namespace multicam_egomotion {

/// A function of time with its first and second derivative, for exact velocities and accelerations.
struct TimeJet {
  double value = 0.0;
  double rate = 0.0;          ///< d/dt
  double acceleration = 0.0;  ///< d²/dt²

  TimeJet() = default;
  TimeJet(double constant) : value(constant) {}
  TimeJet(double v, double d, double dd) : value(v), rate(d), acceleration(dd) {}
  static TimeJet time(double t) { return {t, 1.0, 0.0}; }
};

inline TimeJet operator+(const TimeJet& a, const TimeJet& b) {
  return {a.value + b.value, a.rate + b.rate, a.acceleration + b.acceleration};
}
inline TimeJet operator-(const TimeJet& a, const TimeJet& b) {
  return {a.value - b.value, a.rate - b.rate, a.acceleration - b.acceleration};
}
inline TimeJet operator*(const TimeJet& a, const TimeJet& b) {
  return {a.value * b.value, a.rate * b.value + a.value * b.rate,
          a.acceleration * b.value + 2.0 * a.rate * b.rate + a.value * b.acceleration};
}

/// f(x(t)) from f, f' and f'' at x: the chain rule.
inline TimeJet compose(const TimeJet& x, double f, double f1, double f2) {
  return {f, f1 * x.rate, f2 * x.rate * x.rate + f1 * x.acceleration};
}
inline TimeJet sin(const TimeJet& x) { return compose(x, std::sin(x.value), std::cos(x.value), -std::sin(x.value)); }
inline TimeJet cos(const TimeJet& x) { return compose(x, std::cos(x.value), -std::sin(x.value), -std::cos(x.value)); }

/// Smooth step from 0 (x <= 0) to 1 (x >= 1), three continuous derivatives.
inline TimeJet smoothStep(const TimeJet& x) {
  const double u = x.value;
  if (u <= 0.0) return {0.0};
  if (u >= 1.0) return {1.0};
  const double w = u * (1.0 - u);
  return compose(x, u * u * u * u * (35.0 + u * (-84.0 + u * (70.0 - 20.0 * u))), 140.0 * w * w * w,
                 420.0 * w * w * (1.0 - 2.0 * u));
}

/// Integral of smoothStep: 0 below 0, x - 1/2 above 1. A speed that rises from rest to constant.
inline TimeJet smoothRamp(const TimeJet& x) {
  const double u = x.value;
  if (u <= 0.0) return {0.0};
  if (u >= 1.0) return x - 0.5;
  const double w = u * (1.0 - u);
  const double u4 = u * u * u * u;
  return compose(x, u4 * u * (7.0 + u * (-14.0 + u * (10.0 - 2.5 * u))),
                 u4 * (35.0 + u * (-84.0 + u * (70.0 - 20.0 * u))), 140.0 * w * w * w);
}

}  // namespace multicam_egomotion
