// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "multicam_egomotion/solvers/polynomial_roots.h"

namespace multicam_egomotion {
namespace {

// leading * Π (s - root) * Π ((s - re)² + im²), expanded in long double.
std::array<double, 7> expand(const std::vector<double>& roots, double re = 0, double im = 0, double leading = 1) {
  std::vector<long double> p = {leading};
  const auto times = [&p](std::vector<long double> factor) {
    std::vector<long double> product(p.size() + factor.size() - 1, 0.0L);
    for (size_t i = 0; i < p.size(); ++i) {
      for (size_t j = 0; j < factor.size(); ++j) product[i + j] += p[i] * factor[j];
    }
    p = product;
  };
  for (double root : roots) times({-root, 1.0L});
  if (im != 0) times({static_cast<long double>(re) * re + static_cast<long double>(im) * im, -2.0L * re, 1.0L});
  std::array<double, 7> result = {};
  for (size_t i = 0; i < p.size(); ++i) result[i] = static_cast<double>(p[i]);
  return result;
}

std::vector<double> finite(const RealRoots& roots) {
  std::vector<double> values;
  for (int i = 0; i < roots.count; ++i) values.push_back(roots.reciprocal[i] ? 1 / roots.x[i] : roots.x[i]);
  std::sort(values.begin(), values.end());
  return values;
}

TEST(PolynomialRoots, FindsAllOfSixRealRoots) {
  const std::vector<double> expected = {-250.0, -2.0, -1.0, 0.0, 1e-3, 1.0};
  const std::vector<double> found = finite(findRealRoots(expand(expected)));
  ASSERT_EQ(found.size(), expected.size());
  for (size_t i = 0; i < found.size(); ++i)
    EXPECT_NEAR(found[i], expected[i], 1e-12 * std::max(1.0, std::abs(found[i])));
}

// At s = 1 and -1, where s and 1 / s meet, rounding decides on which side a root lies.
TEST(PolynomialRoots, FindsRootsWhereTheChartsMeet) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  for (int trial = 0; trial < 20000; ++trial) {
    const double end = trial % 2 ? 1.0 : -1.0;
    std::vector<double> expected = {end};
    while (expected.size() < 4) {
      const double other = std::tan(normal(random));
      if (std::abs(other - end) > 0.1) expected.push_back(other);
    }
    const std::vector<double> found = finite(findRealRoots(expand(expected, normal(random), 1.0)));
    double nearest = 1.0;
    for (double root : found) nearest = std::min(nearest, std::abs(root - end));
    EXPECT_LT(nearest, 1e-10) << trial;
  }
}

TEST(PolynomialRoots, FindsRandomRootsWithTheirTrueNumber) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  for (int trial = 0; trial < 20000; ++trial) {
    const int count = 2 * (trial % 3) + 2;
    std::vector<double> expected;
    for (int i = 0; i < count; ++i)
      expected.push_back(trial % 2 ? 0.05 * normal(random) + 0.3 : std::tan(normal(random)));
    std::sort(expected.begin(), expected.end());
    double gap = 1;
    for (int i = 1; i < count; ++i) gap = std::min(gap, expected[i] - expected[i - 1]);
    if (gap < 3e-3) continue;
    const bool pair = count == 4;
    const std::vector<double> found =
        finite(findRealRoots(expand(expected, normal(random), pair ? 0.1 : 0.0), pair ? 6 : count));
    ASSERT_EQ(found.size(), expected.size()) << "trial " << trial;
    for (int i = 0; i < count; ++i) ASSERT_NEAR(found[i], expected[i], 1e-5 * (1 + std::abs(expected[i]))) << trial;
  }
}

TEST(PolynomialRoots, FindsFourRootsInOneCell) {
  const std::vector<double> expected = {-2.29e-3, -3.17e-3, -0.0145, -0.0264, 12.0};
  std::vector<double> sorted = expected;
  std::sort(sorted.begin(), sorted.end());
  const std::vector<double> found = finite(findRealRoots(expand(expected), 5));
  ASSERT_EQ(found.size(), 5u);
  for (size_t i = 0; i < 5; ++i) EXPECT_NEAR(found[i], sorted[i], 1e-10 * (1 + std::abs(sorted[i])));
}

TEST(PolynomialRoots, RootAtInfinityIsTheReciprocalOfZero) {
  const RealRoots roots = findRealRoots(expand({0.5, -3.0, 2.0, 0.1, -0.7}), 6);
  ASSERT_EQ(roots.count, 6);
  int infinite = 0;
  for (int i = 0; i < roots.count; ++i) infinite += roots.reciprocal[i] && std::abs(roots.x[i]) < 1e-15;
  EXPECT_EQ(infinite, 1);
  EXPECT_EQ(findRealRoots(expand({0.5, -3.0, 2.0, 0.1, -0.7}), 5).count, 5);
}

TEST(PolynomialRoots, DoubleRootAppearsOnceOrAsTwoAtRounding) {
  for (double root : {0.0, 0.3, 0.97, -0.9, 40.0}) {
    const RealRoots roots = findRealRoots(expand({root, root, -0.5}, 0.2, 0.4), 5);
    ASSERT_GE(roots.count, 2) << root;
    ASSERT_LE(roots.count, 3) << root;
    for (double value : finite(roots)) {
      EXPECT_LT(std::min(std::abs(value - root), std::abs(value + 0.5)), 1e-6 * (1 + std::abs(root) * std::abs(root)));
    }
  }
}

TEST(PolynomialRoots, ScaleDoesNotMatter) {
  for (double scale : {1e-280, 1e-100, 1.0, 1e100, 1e280}) {
    EXPECT_EQ(findRealRoots(expand({0.1, 0.2, -5.0, 2.0}, 0.3, 0.7, scale)).count, 4) << scale;
  }
}

TEST(PolynomialRoots, NoRootsOfNothing) {
  EXPECT_EQ(findRealRoots({}).count, 0);
  EXPECT_EQ(findRealRoots(expand({}, 0.3, 0.7), 2).count, 0);
  EXPECT_EQ(findRealRoots({1, 2, std::numeric_limits<double>::quiet_NaN(), 0, 0, 0, 1}).count, 0);
  EXPECT_EQ(findRealRoots({1, 2, std::numeric_limits<double>::infinity(), 0, 0, 0, 1}).count, 0);
  EXPECT_EQ(findRealRoots({1, 2, 3, 4, 5, 6, 7}, 7).count, 0);
}

}  // namespace
}  // namespace multicam_egomotion
