// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

namespace multicam_egomotion {

/// MSAC's truncated square, marginalized over its threshold. With a threshold τ between `core` and `limit`, all equally
/// likely, the mean of min(e² / τ², 1) is, for an error e ≥ 0 and c = core, l = limit,
///   e² / (c l)                        e ≤ c
///   (2 e - c - e² / l) / (l - c)      c < e < l
///   1                                 e ≥ l
/// so it is as efficient as least squares within the core, fades out smoothly, and needs no exact threshold. With
/// core = limit it is MSAC (Torr and Zisserman 2000); the idea of marginalizing is that of MAGSAC (Barath et al. 2019).
struct RobustLoss {
  double core = 2.0;   ///< [px]
  double limit = 2.0;  ///< [px], at least the core

  double value(double error) const {
    if (error <= core) return error * error / (core * limit);
    if (error >= limit) return 1.0;
    return (2.0 * error - core - error * error / limit) / (limit - core);
  }
  /// Weight of iterative reweighting, 1 within the core: d value / d error over that of the square e² / (c l).
  double weight(double error) const {
    if (error <= core) return 1.0;
    if (error >= limit) return 0.0;
    return core * (limit - error) / (error * (limit - core));
  }
};

}  // namespace multicam_egomotion
