// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "multicam_egomotion/odometry/ego_motion_result.h"

namespace multicam_egomotion {

const char* name(EgoMotionStatus status) {
  switch (status) {
    case EgoMotionStatus::kInitializing:
      return "INITIALIZING";
    case EgoMotionStatus::kTracking:
      return "TRACKING";
    case EgoMotionStatus::kCoasting:
      return "COASTING";
    case EgoMotionStatus::kLost:
      return "LOST";
  }
  return "";
}

const char* name(ScaleState state) {
  switch (state) {
    case ScaleState::kNotApplicable:
      return "NOT_APPLICABLE";
    case ScaleState::kObservable:
      return "OBSERVABLE";
    case ScaleState::kWeak:
      return "WEAK";
    case ScaleState::kUnobservable:
      return "UNOBSERVABLE";
  }
  return "";
}

}  // namespace multicam_egomotion
