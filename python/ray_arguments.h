// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "array_arguments.h"
#include "multicam_egomotion/geometry/ray.h"

namespace multicam_egomotion {

/// Plücker lines in Python: arrays of shape (n, 6), a row holds the direction (unit) and the moment (center ×
/// direction).
inline std::vector<RayCorrespondence> raysArgument(const pybind11::handle& rays1, const pybind11::handle& rays2,
                                                   const pybind11::handle& cameras1, const pybind11::handle& cameras2,
                                                   int cameras, pybind11::ssize_t size = -1) {
  const Rows<6> first = rowsArgument<6>("rays1", rays1, size);
  const Rows<6> second = rowsArgument<6>("rays2", rays2, first.rows());
  const std::vector<int> c1 = camerasArgument("cameras1", cameras1, first.rows(), cameras);
  const std::vector<int> c2 = camerasArgument("cameras2", cameras2, first.rows(), cameras);
  std::vector<RayCorrespondence> result(first.rows());
  for (std::size_t i = 0; i < result.size(); ++i) {
    const auto line = [i](const Rows<6>& rows) {
      const double length = rows.row(i).head<3>().norm();
      return Ray{rows.row(i).head<3>().transpose() / length, rows.row(i).tail<3>().transpose() / length};
    };
    result[i] = {line(first), line(second), c1[i], c2[i]};
  }
  return result;
}

}  // namespace multicam_egomotion
