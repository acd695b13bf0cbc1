// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "simulator/trajectory.h"

namespace multicam_egomotion {

/// Motions of base_link, t = 0 at the first image.
Trajectory handheldMotion();      ///< fast, all six degrees of freedom, in motion from the start
Trajectory carMotion();           ///< from rest, then 5 to 8 m/s with turns; base_link at the rear axle
Trajectory droneMotion();         ///< from hovering, 2 m/s with banked turns
Trajectory straightLineMotion();  ///< no rotation at all, varying speed, in motion from the start
Trajectory stopAndGoMotion();     ///< 6 s of driving, 10 s of standing, 6 s of driving; then standing
Trajectory creepMotion();         ///< 2 s of standing, 10 s at 2 cm/s, standing
Trajectory loopMotion();          ///< like handheldMotion(), but the same again every 60 s

/// Mounting of base_link on the moving frame of handheldMotion() and loopMotion() (x forward, z up).
Eigen::Matrix3d handheldMounting();

}  // namespace multicam_egomotion
