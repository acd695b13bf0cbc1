// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "five_point_martyushev_tables.h"

#include <cmath>

namespace multicam_egomotion {
namespace sphere {
namespace {

constexpr int kMaxDegree = 8;
constexpr double kPi = 3.14159265358979323846;

struct Point {
  double x, y, z, weight;
};

/// Node `i` of the Gauss-Legendre rule of `count` nodes on [-1, 1] and its weight; the weights sum to 1.
void gaussLegendre(int i, int count, double& node, double& weight) {
  node = std::cos(kPi * (i + 0.75) / (count + 0.5));
  double derivative = 1;
  for (int iteration = 0; iteration < 20; ++iteration) {
    double previous = 1, value = node;
    for (int l = 2; l <= count; ++l) {
      const double next = ((2 * l - 1) * node * value - (l - 1) * previous) / l;
      previous = value;
      value = next;
    }
    derivative = count * (node * value - previous) / (node * node - 1);
    node -= value / derivative;
  }
  weight = 1 / ((1 - node * node) * derivative * derivative);
}

/// Quadrature of the mean over the sphere, exact for polynomials of degree < min(2 heights, azimuths).
std::vector<Point> grid(int heights, int azimuths) {
  std::vector<Point> points;
  for (int i = 0; i < heights; ++i) {
    double z, weight;
    gaussLegendre(i, heights, z, weight);
    for (int j = 0; j < azimuths; ++j) {
      const double azimuth = 2 * kPi * j / azimuths, r = std::sqrt(1 - z * z);
      points.push_back({r * std::cos(azimuth), r * std::sin(azimuth), z, weight / azimuths});
    }
  }
  return points;
}

double coupling(int l, int m) { return std::sqrt((l * l - m * m) / (4.0 * l * l - 1)); }

/// All harmonics of degree ≤ 8 at one point.
void harmonics(const Point& point, double* values) {
  const double x = point.x, y = point.y, z = point.z;
  double c = 1, s = 0, sectoral = 1;  // c + i s = (x + i y)^m
  for (int m = 0; m <= kMaxDegree; ++m) {
    if (m > 0) {
      const double turned = c * x - s * y;
      s = c * y + s * x;
      c = turned;
      sectoral *= std::sqrt((2.0 * m + 1) / (2.0 * m)) * (m == 1 ? std::sqrt(2.0) : 1.0);
    }
    double before = 0, legendre = sectoral;
    for (int l = m; l <= kMaxDegree; ++l) {
      values[l * l + l + m] = legendre * c;
      if (m > 0) values[l * l + l - m] = legendre * s;
      const double next = (z * legendre - (l > m ? coupling(l, m) * before : 0.0)) / coupling(l + 1, m);
      before = legendre;
      legendre = next;
    }
  }
}

Tables compute() {
  Tables t = {};
  double values[kDegree8];
  const std::vector<Point> points = grid(7, kPoints / 7);
  for (int p = 0; p < kPoints; ++p) {
    const double x = points[p].x, y = points[p].y, z = points[p].z;
    const double quadratic[kQuadratic] = {1, x, y, z, x * x, y * y, x * y, x * z, y * z};
    for (int k = 0; k < kQuadratic; ++k) t.quadratic[k][p] = quadratic[k];
    harmonics(points[p], values);
    for (int k = 0; k < kDegree6; ++k) t.projection[p][k] = points[p].weight * values[k];
  }
  for (int l = 1; l <= kMaxDegree; ++l) {
    for (int m = -l; m <= l; ++m) t.z_coupling[l][l + m] = coupling(l, m);
  }

  std::vector<double> mean(kQuadratic * kDegree8 * kDegree6, 0.0);
  for (const Point& point : grid(9, 18)) {
    harmonics(point, values);
    double* sum = mean.data();
    for (int factor = 0; factor < kQuadratic; ++factor) {
      for (int row = 0; row < kDegree8; ++row) {
        const double weighted = point.weight * values[factor] * values[row];
        for (int column = 0; column < kDegree6; ++column) *sum++ += weighted * values[column];
      }
    }
  }
  const double* value = mean.data();
  for (int factor = 0; factor < kQuadratic; ++factor) {
    for (int row = 0; row < kDegree8; ++row) {
      for (int column = 0; column < kDegree6; ++column, ++value) {
        if (std::abs(*value) > 1e-10) t.times[factor].push_back({row, column, *value});
      }
    }
  }
  return t;
}

}  // namespace

const Tables& tables() {
  static const Tables result = compute();
  return result;
}

}  // namespace sphere
}  // namespace multicam_egomotion
