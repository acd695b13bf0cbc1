// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>

namespace multicam_egomotion {

/// The rigid motion a 4x4 matrix of a calibration file stands for: a deviation from orthogonality of up to 1e-3 (four
/// digits) is removed. Throws std::invalid_argument ("is not a rigid motion: ...") beyond, on a mirror image, on a last
/// row other than 0 0 0 1, and on an entry that is not finite.
Eigen::Isometry3d rigidTransform(const Eigen::Matrix4d& matrix);

}  // namespace multicam_egomotion
