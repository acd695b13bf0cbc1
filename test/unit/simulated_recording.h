// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "ego_motion_run.h"
#include "simulator/simulator.h"

namespace multicam_egomotion {

/// All of a simulated run; its images are rendered each time they are asked for. `simulator` must outlive it.
inline Recording recordingOf(const Simulator& simulator) {
  Recording recording;
  recording.frames = simulator.frames();
  recording.imu = simulator.imuSamples();
  recording.images = [&simulator](int frame) { return simulator.renderFrame(frame).images; };
  recording.stamp = [&simulator](int frame) { return simulator.frameStamp(frame); };
  return recording;
}

}  // namespace multicam_egomotion
