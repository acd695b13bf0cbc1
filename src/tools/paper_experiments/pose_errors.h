// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace multicam_egomotion {

constexpr double kDegree = M_PI / 180.0;

/// Errors of a relative pose [rad]. The paper's arccos cannot resolve less than 1e-8.
struct PoseErrors {
  double rotation = M_PI;     ///< 2 asin(|R - R_gt|_F / (2 sqrt 2))
  double translation = M_PI;  ///< of the direction: atan2(|t x t_gt|, t · t_gt)
};

inline PoseErrors poseErrors(const Eigen::Matrix3d& R, const Eigen::Vector3d& t, const Eigen::Matrix3d& R_true,
                             const Eigen::Vector3d& t_true) {
  return {2.0 * std::asin(std::min(1.0, (R - R_true).norm() / (2.0 * std::sqrt(2.0)))),
          std::atan2(t.cross(t_true).norm(), t.dot(t_true))};
}

/// Value below which a share of the values lies, interpolated; NaN where there are none.
inline double quantile(std::vector<double> values, double share) {
  if (values.empty()) return std::nan("");
  std::sort(values.begin(), values.end());
  const double position = share * static_cast<double>(values.size() - 1);
  const auto below = static_cast<std::size_t>(position);
  const std::size_t above = std::min(below + 1, values.size() - 1);
  return values[below] + (position - static_cast<double>(below)) * (values[above] - values[below]);
}

inline double median(std::vector<double> values) { return quantile(std::move(values), 0.5); }

}  // namespace multicam_egomotion
