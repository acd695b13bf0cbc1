// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "quartic_roots.h"

#include <algorithm>
#include <cmath>

namespace multicam_egomotion {
namespace {

constexpr double kDouble = 1e-8;     // relative discriminant that may be a double root's
constexpr double kSmallEnds = 1e-4;  // of the first and last coefficient, relative to the largest
constexpr double kInfinity = 1e-12;  // of 1 / x, relative to the other roots

// Largest real root of z³ + b z² + c z + d.
double largestCubicRoot(double b, double c, double d) {
  const double third = b / 3;
  // y³ - 3 p y + 2 q with z = y - b / 3
  const double p = third * third - c / 3;
  const double q = third * third * third - 0.5 * (third * c - d);
  const double discriminant = q * q - p * p * p;
  double y;
  if (discriminant > 0) {
    const double u = -std::copysign(std::cbrt(std::abs(q) + std::sqrt(discriminant)), q);
    y = u + p / u;
  } else {
    const double root = std::sqrt(std::max(p, 0.0));
    y = root > 0 ? 2 * root * std::cos(std::acos(std::clamp(-q / (p * root), -1.0, 1.0)) / 3) : 0.0;
  }
  return y - third;
}

// Adds the roots of x² + b x + c, shifted.
void addQuadraticRoots(double b, double c, double shift, QuarticRoots& roots) {
  const double half = -0.5 * b, discriminant = half * half - c;
  if (!(discriminant >= -kDouble * (half * half + std::abs(c)))) return;
  const double root = std::sqrt(std::max(discriminant, 0.0));
  roots.x[roots.count++] = half + root + shift;
  roots.x[roots.count++] = half - root + shift;
}

// Roots of x³ + a2 x² + a1 x + a0.
void addCubicRoots(double a2, double a1, double a0, QuarticRoots& roots) {
  const double x = largestCubicRoot(a2, a1, a0);
  roots.x[roots.count++] = x;
  addQuadraticRoots(a2 + x, a1 + x * (a2 + x), 0, roots);
}

// Roots of x⁴ + a3 x³ + a2 x² + a1 x + a0.
void addQuarticRoots(double a3, double a2, double a1, double a0, QuarticRoots& roots) {
  // x = y - a3 / 4: y⁴ + p y² + q y + r
  const double shift = -0.25 * a3, square = shift * shift;
  const double p = a2 - 6 * square;
  const double q = a1 + 2 * shift * (a2 - 4 * square);
  const double r = a0 + shift * (a1 + shift * (a2 - 3 * square));
  // (y² + w y + (p + z - q / w) / 2) (y² - w y + (p + z + q / w) / 2), w² = z
  const double z = std::max(largestCubicRoot(2 * p, p * p - 4 * r, -q * q), 0.0);
  const double w = std::sqrt(z), half = 0.5 * (p + z);
  const double ratio = w > 0 ? 0.5 * q / w : std::sqrt(std::max(half * half - r, 0.0));
  addQuadraticRoots(w, half - ratio, shift, roots);
  addQuadraticRoots(-w, half + ratio, shift, roots);
}

// The larger end leads; if it is the constant term the roots are reciprocal.
QuarticRoots rootsFromLargerEnd(const double* c, bool cubic) {
  QuarticRoots found, roots;
  const int degree = cubic ? 3 : 4;
  const bool reversed = std::abs(c[0]) > std::abs(c[degree]);
  const double leading = 1.0 / (reversed ? c[0] : c[degree]);
  if (!std::isfinite(leading)) return roots;
  double a[4];
  for (int k = 0; k < degree; ++k) a[k] = leading * (reversed ? c[degree - k] : c[k]);
  if (cubic) {
    addCubicRoots(a[2], a[1], a[0], found);
  } else {
    addQuarticRoots(a[3], a[2], a[1], a[0], found);
  }
  if (!reversed) return found;
  double largest = 0;
  for (int i = 0; i < found.count; ++i) largest = std::max(largest, std::abs(found.x[i]));
  for (int i = 0; i < found.count; ++i) {
    if (std::abs(found.x[i]) > kInfinity * largest) roots.x[roots.count++] = 1 / found.x[i];
  }
  return roots;
}

}  // namespace

QuarticRoots quarticRootsInClosedForm(const double* c) {
  QuarticRoots roots;
  const bool cubic = c[4] == 0;
  const double largest = std::max({std::abs(c[0]), std::abs(c[1]), std::abs(c[2]), std::abs(c[3]), std::abs(c[4])});
  const double sum = c[0] + c[1] + c[2] + c[3] + c[4];
  if (!std::isfinite(sum)) return roots;
  if (std::max(std::abs(c[0]), std::abs(c[cubic ? 3 : 4])) > kSmallEnds * largest) return rootsFromLargerEnd(c, cubic);

  // Roots near zero and near infinity at once: x = (1 + z) / (1 - z) puts them at -1 and 1.
  const double alternating = c[0] - c[1] + c[2] - c[3] + c[4];
  const double moved[5] = {sum, 4 * (c[4] - c[0]) + 2 * (c[3] - c[1]), 6 * (c[0] + c[4]) - 2 * c[2],
                           4 * (c[4] - c[0]) - 2 * (c[3] - c[1]), alternating};
  const QuarticRoots found = rootsFromLargerEnd(moved, false);
  for (int i = 0; i < found.count; ++i) {
    const double below = 1 - found.x[i];
    if (std::abs(below) > kInfinity) roots.x[roots.count++] = (1 + found.x[i]) / below;
  }
  return roots;
}

}  // namespace multicam_egomotion
