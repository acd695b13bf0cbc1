// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "multicam_egomotion/estimation/inlier_weights.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace multicam_egomotion {
namespace {

constexpr int kBins = 26, kFarthest = -20;  // half octaves of the distance
constexpr double kCoreSigmas = 2.5;
constexpr double kSideBegin = 2.0, kSideEnd = 22.0;  // in limits
constexpr double kUnseen = 0.01;                     // inliers expected at a distance at which no other is
constexpr double kBent = 2.0;                        // outliers to which the pose may have been bent

constexpr double kLeastProbability = 0.1;  // of an inlier

constexpr double kMeanDistrust = 0.25;
constexpr double kFirstLeverage = 0.1, kLeastLeverage = 1e-8;  // [rad^2]
constexpr int kLeverageSteps = 5;

// Half octaves of the nearness; points without parallax are the farthest.
int binOf(double nearness) {
  if (!(nearness > 0.0)) return 1;
  return std::min(std::max(std::ilogb(nearness * nearness) - kFarthest, 1), kBins);
}

// Leverage s at which the mean of q / (q + s) over leverages q is kMeanDistrust: a fixed point.
double trustedLeverage(const std::vector<double>& leverages) {
  double scale = kFirstLeverage;
  for (int i = 0; i < kLeverageSteps; ++i) {
    double sum = 0.0;
    for (double q : leverages) sum += q / (q + scale);
    const double distrust = std::min(std::max(sum / std::max<std::size_t>(1, leverages.size()), 1e-3), 0.9);
    scale = std::max(scale * distrust / (1.0 - distrust) * (1.0 - kMeanDistrust) / kMeanDistrust, kLeastLeverage);
  }
  return scale;
}

}  // namespace

void weighInliers(const CorrespondenceSet::Residuals& residuals, double sigma, double limit,
                  std::vector<double>* weights) {
  const std::vector<double>& errors = residuals.errors;
  const double core = std::min(kCoreSigmas * sigma, limit);
  std::array<int, kBins + 2> core_counts{}, side_counts{};
  for (std::size_t i = 0; i < errors.size(); ++i) {
    if (errors[i] < core) ++core_counts[binOf(residuals.nearness[i])];
    if (errors[i] > kSideBegin * limit && errors[i] < kSideEnd * limit) ++side_counts[binOf(residuals.nearness[i])];
  }
  // Density of inliers without error over that of outliers.
  std::array<double, kBins + 1> odds{};
  for (int bin = 1; bin <= kBins; ++bin) {
    const auto window = [bin](const std::array<int, kBins + 2>& counts) {
      return counts[bin - 1] + counts[bin] + counts[bin + 1];
    };
    const double outliers = window(side_counts) / ((kSideEnd - kSideBegin) * limit);  // a pixel
    const double others = std::max(window(core_counts) - 1.0 - kBent - outliers * core, kUnseen);
    odds[bin] =
        outliers > 0.0 ? others * std::sqrt(2.0 / M_PI) / (sigma * outliers) : std::numeric_limits<double>::infinity();
  }
  weights->assign(errors.size(), 0.0);
  std::vector<double> leverages;
  leverages.reserve(errors.size());
  for (std::size_t i = 0; i < errors.size(); ++i) {
    if (!(errors[i] < limit)) continue;
    const double square = errors[i] / sigma * (errors[i] / sigma);
    const double probability = 1.0 / (1.0 + std::exp(0.5 * square) / odds[binOf(residuals.nearness[i])]);
    if (probability < kLeastProbability) continue;
    (*weights)[i] = probability;
    leverages.push_back(residuals.leverages[i]);
  }
  const double scale = trustedLeverage(leverages);
  for (std::size_t i = 0; i < errors.size(); ++i) {
    (*weights)[i] *= scale / (scale + residuals.leverages[i]);
  }
}

}  // namespace multicam_egomotion
