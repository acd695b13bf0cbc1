// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "bernstein_roots.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

namespace multicam_egomotion {
namespace {

constexpr int kDegree = 8;

struct Search {
  std::array<double, kDegree + 1> c;  // of s, or of 1 / s where `reciprocal`
  std::array<double, kDegree> slope;
  std::array<double, kDegree + 1> noise;  // of c
  double largest_noise;                   // of the value at |x| = 1
  bool reciprocal;
  int subdivisions;
  ProjectiveRoots* roots;

  // Error of the values, and of the Bernstein coefficients, where |x| ≤ `largest`.
  double noiseWithin(double largest) const {
    double value = noise[kDegree];
    for (int k = kDegree; k-- > 0;) value = value * largest + noise[k];
    return value;
  }

  void add(double x, bool touching) {
    if (roots->count < static_cast<int>(roots->roots.size())) roots->roots[roots->count++] = {x, reciprocal, touching};
  }
};

// Newton steps kept inside a bracket of one root.
double rootInBracket(const Search& search, double lo, double hi, double p_lo, double p_hi) {
  constexpr double kStep = 1e-6;  // the last step leaves about its square
  constexpr double kPrecision = 1e-11;
  constexpr int kIterations = 80;
  const std::array<double, kDegree + 1>& c = search.c;
  const std::array<double, kDegree>& d = search.slope;
  double x = p_lo == p_hi ? 0.5 * (lo + hi) : lo + (hi - lo) * (p_lo / (p_lo - p_hi));
  for (int i = 0; i < kIterations; ++i) {
    const double y = x * x;
    const double p =
        ((((c[8] * y + c[6]) * y + c[4]) * y + c[2]) * y + c[0]) + x * (((c[7] * y + c[5]) * y + c[3]) * y + c[1]);
    const double slope = (((d[6] * y + d[4]) * y + d[2]) * y + d[0]) + x * (((d[7] * y + d[5]) * y + d[3]) * y + d[1]);
    ((p < 0) == (p_lo < 0) ? lo : hi) = x;
    const double step = p / slope;
    const double next = x - step;
    if (next >= lo && next <= hi) {
      x = next;
      if (std::abs(step) < kStep) break;
    } else {
      x = 0.5 * (lo + hi);
      if (hi - lo < kPrecision) break;
    }
  }
  return x;
}

// Sign changes of the coefficients, and how many there may be where those within the noise have any sign.
struct Variations {
  int certain, possible;
};

// On [lo, hi].
Variations variations(const Search& search, const double* b, double lo, double hi) {
  Variations found = {0, 0};
  double smallest = std::abs(b[0]);
  for (int i = 1; i <= kDegree; ++i) {
    found.certain += (b[i - 1] < 0) != (b[i] < 0);
    smallest = std::min(smallest, std::abs(b[i]));
  }
  found.possible = found.certain;
  if (smallest > search.largest_noise) return found;
  const double noise = search.noiseWithin(std::max(std::abs(lo), std::abs(hi)));
  if (smallest <= noise) {
    // Each one within the noise takes the sign opposite to the one before; those ahead of all others alternate too.
    int first = 0;
    while (first < kDegree && std::abs(b[first]) <= noise) ++first;
    found.possible = first;
    bool negative = b[first] < 0;
    for (int i = first + 1; i <= kDegree; ++i) {
      const bool next = std::abs(b[i]) <= noise ? !negative : b[i] < 0;
      found.possible += next != negative;
      negative = next;
    }
  }
  return found;
}

void isolate(Search& search, const double* b, double lo, double hi) {
  constexpr double kNarrowest = 1e-7;
  constexpr int kMaxSubdivisions = 300;  // a polynomial of rounding alone must not take for ever
  const Variations found = variations(search, b, lo, hi);
  if (found.possible == 0) return;
  if (found.certain == 1 && found.possible == 1) {
    search.add(rootInBracket(search, lo, hi, b[0], b[kDegree]), false);
    return;
  }
  if (found.possible == 1) return;  // a root at one end, which belongs to the neighbour
  if (hi - lo < kNarrowest || search.subdivisions++ >= kMaxSubdivisions) {
    if (found.certain & 1) {
      search.add(rootInBracket(search, lo, hi, b[0], b[kDegree]), false);
    } else {
      search.add(0.5 * (lo + hi), true);
    }
    return;
  }
  double left[kDegree + 1], right[kDegree + 1];
  for (int i = 0; i <= kDegree; ++i) right[i] = b[i];
  left[0] = right[0];
  double scale = 1;  // sums take the place of means
  for (int order = 1; order <= kDegree; ++order) {
    for (int i = 0; i <= kDegree - order; ++i) right[i] += right[i + 1];
    scale *= 0.5;
    left[order] = scale * right[0];
  }
  for (int i = 0; i < kDegree; ++i) {
    right[i] *= scale;
    scale *= 2;
  }
  const double middle = 0.5 * (lo + hi);
  isolate(search, left, lo, middle);
  isolate(search, right, middle, hi);
}

// Bernstein coefficients on [0, 1] of four polynomials side by side.
void toBernstein(std::array<Eigen::Array4d, kDegree + 1>& b) {
  constexpr double kInverseBinomial[kDegree + 1] = {1, 1. / 8, 1. / 28, 1. / 56, 1. / 70, 1. / 56, 1. / 28, 1. / 8, 1};
  for (int k = 0; k <= kDegree; ++k) b[k] *= kInverseBinomial[k];
  for (int order = 1; order <= kDegree; ++order) {
    for (int k = kDegree; k >= order; --k) b[k] += b[k - 1];
  }
}

}  // namespace

ProjectiveRoots realRootsByBernstein(const std::array<double, 9>& coefficients, int degree,
                                     const std::array<double, 9>& noise) {
  ProjectiveRoots roots;
  double c[2][kDegree + 1] = {}, at_plus = 0, at_minus = 0, largest_noise = 0;
  for (int k = 0; k <= degree; ++k) {
    largest_noise += noise[k];
    c[0][k] = coefficients[k];
    c[1][degree - k] = coefficients[k];
    at_plus += coefficients[k];
    at_minus += k & 1 ? -coefficients[k] : coefficients[k];
  }
  // Of c[0](x), c[0](-x), c[1](x) and c[1](-x).
  std::array<Eigen::Array4d, kDegree + 1> b;
  for (int k = 0; k <= kDegree; ++k) {
    const double sign = k & 1 ? -1 : 1;
    b[k] = Eigen::Array4d(c[0][k], sign * c[0][k], c[1][k], sign * c[1][k]);
  }
  toBernstein(b);
  for (int chart = 0; chart < 2; ++chart) {
    Search search = {{}, {}, {}, largest_noise, chart == 1, 0, &roots};
    std::copy(c[chart], c[chart] + kDegree + 1, search.c.begin());
    for (int k = 0; k <= degree; ++k) search.noise[k] = noise[chart == 0 ? k : degree - k];
    for (int k = 0; k < kDegree; ++k) search.slope[k] = (k + 1) * search.c[k + 1];
    double positive[kDegree + 1], negative[kDegree + 1];
    for (int k = 0; k <= kDegree; ++k) {
      positive[k] = b[k][2 * chart];
      negative[kDegree - k] = b[k][2 * chart + 1];
    }
    // At s = ±1 the first chart's values hold for both, so that a root there is found once: s^degree is ±1.
    positive[kDegree] = at_plus;
    negative[0] = chart == 1 && degree & 1 ? -at_minus : at_minus;
    isolate(search, negative, -1, 0);
    isolate(search, positive, 0, 1);
  }
  return roots;
}

}  // namespace multicam_egomotion
