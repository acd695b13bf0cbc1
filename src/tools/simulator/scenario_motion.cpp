// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "simulator/scenario_motion.h"

#include <cmath>

#include "simulator/planar_path.h"

namespace multicam_egomotion {

namespace {

/// amplitude * sin(2 pi (frequency t + phase)).
TimeJet wave(const TimeJet& t, double amplitude, double frequency_hz, double phase = 0.0) {
  return amplitude * sin(t * (2.0 * M_PI * frequency_hz) + 2.0 * M_PI * phase);
}

/// Distance travelled at `speed` between two moments, with smooth starts and stops of `ramp` seconds; exactly constant
/// before and after.
TimeJet drive(const TimeJet& t, double from, double to, double ramp, double speed) {
  if (t.value >= to + ramp) return {(to - from) * speed};
  const TimeJet start = smoothRamp((t - from) * (1.0 / ramp)), stop = smoothRamp((t - to) * (1.0 / ramp));
  return (start - stop) * (ramp * speed);
}

}  // namespace

Eigen::Matrix3d handheldMounting() {
  return (Eigen::AngleAxisd(0.35, Eigen::Vector3d::UnitZ()) * Eigen::AngleAxisd(-0.25, Eigen::Vector3d::UnitY()) *
          Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitX()))
      .toRotationMatrix();
}

Trajectory handheldMotion() {
  return Trajectory(
      [](const TimeJet& t) {
        MotionJet m;
        m.x = wave(t, 2.6, 0.08) + wave(t, 0.10, 0.9, 0.3);
        m.y = wave(t, 1.8, 0.11, 0.2) + wave(t, 0.08, 1.1);
        m.z = 1.5 + wave(t, 0.30, 0.19) + wave(t, 0.05, 1.7, 0.1);
        m.yaw = t * 0.22 + wave(t, 0.45, 0.33, 0.1) + wave(t, 0.05, 1.3);
        m.pitch = wave(t, 0.22, 0.41) + wave(t, 0.03, 1.5, 0.4);
        m.roll = wave(t, 0.28, 0.29, 0.3) + wave(t, 0.04, 1.2, 0.2);
        return m;
      },
      handheldMounting());
}

Trajectory loopMotion() {
  return Trajectory(
      [](const TimeJet& t) {
        const TimeJet lap = t * (1.0 / 60.0);  // frequencies are whole numbers a lap
        MotionJet m;
        m.x = wave(lap, 2.6, 5) + wave(lap, 0.10, 54, 0.3);
        m.y = wave(lap, 1.8, 7, 0.2) + wave(lap, 0.08, 66);
        m.z = 1.5 + wave(lap, 0.30, 11) + wave(lap, 0.05, 102, 0.1);
        m.yaw = lap * (2.0 * 2.0 * M_PI) + wave(lap, 0.45, 20, 0.1) + wave(lap, 0.05, 78);
        m.pitch = wave(lap, 0.22, 25) + wave(lap, 0.03, 90, 0.4);
        m.roll = wave(lap, 0.28, 17, 0.3) + wave(lap, 0.04, 72, 0.2);
        return m;
      },
      handheldMounting());
}

Trajectory carMotion() {
  // Half a lap turns by 180 deg, so that two halves close.
  const double quarter = 0.5 * M_PI;
  const PlanarPath path({{14.0, 0.0}, {32.0, quarter}, {10.0, 0.0}, {18.0, -0.4}, {18.0, 0.4}, {32.0, quarter}});
  return Trajectory([path](const TimeJet& t) {
    // One second at rest, 2.5 m/s² up to speed, then 5 to 8 m/s.
    const TimeJet cruise = t - 3.6;
    const TimeJet s = drive(t, 1.0, 1e6, 2.6, 6.5) + smoothStep(cruise * 0.5) * wave(cruise, 1.9, 0.125);
    const PlanarPath::Point point = path.at(s);
    const TimeJet rolling = smoothStep((t - 1.0) * 0.4);
    MotionJet m;
    m.x = point.x;
    m.y = point.y;
    m.z = rolling * wave(t, 0.008, 1.3);
    m.yaw = point.heading;
    m.pitch = rolling * (wave(t, 0.006, 0.9, 0.2) + wave(t, 0.004, 1.7));
    m.roll = rolling * (wave(t, 0.009, 0.4, 0.1) + wave(t, 0.003, 1.9));
    return m;
  });
}

Trajectory droneMotion() {
  return Trajectory([](const TimeJet& t) {
    const TimeJet flight = 2.0 * smoothRamp((t - 0.5) * 0.5);  // own time of the path, slow at the start
    const TimeJet flying = smoothStep((t - 0.5) * 0.5);
    MotionJet m;
    m.x = wave(flight, 6.0, 0.045);
    m.y = wave(flight, 4.0, 0.075, 0.05);
    m.z = 3.0 + wave(flight, 1.0, 0.07);
    m.yaw = flight * 0.18 + wave(flight, 0.5, 0.09);
    m.pitch = flying * (0.05 + wave(t, 0.09, 0.31, 0.1) + wave(t, 0.01, 2.1));
    m.roll = flying * (wave(t, 0.12, 0.23) + wave(t, 0.01, 1.9));
    return m;
  });
}

Trajectory straightLineMotion() {
  return Trajectory([](const TimeJet& t) {
    const TimeJet s = t * 1.5 + wave(t, 0.5, 0.2);  // 0.9 to 2.1 m/s
    MotionJet m;
    m.x = s;
    m.y = s * 0.05;
    m.z = 1.4;
    m.yaw = 0.05;
    m.pitch = 0.03;
    m.roll = -0.02;
    return m;
  });
}

Trajectory stopAndGoMotion() {
  const PlanarPath path({{3.0, 0.0}, {4.0, 0.9}, {2.0, 0.0}, {5.0, -1.6}, {4.0, 0.0}, {5.0, 1.2}, {60.0, -3.0}});
  return Trajectory([path](const TimeJet& t) {
    const TimeJet s = drive(t, 0.3, 4.5, 1.5, 1.4) + drive(t, 16.0, 20.5, 1.5, 1.4);
    const PlanarPath::Point point = path.at(s);
    MotionJet m;
    m.x = point.x;
    m.y = point.y;
    // Along the path, not in time: at rest nothing moves at all.
    m.z = 1.0 + wave(s, 0.01, 0.8);
    m.yaw = point.heading;
    m.pitch = 0.02 + wave(s, 0.01, 0.7);
    m.roll = wave(s, 0.015, 0.4);
    return m;
  });
}

Trajectory creepMotion() {
  return Trajectory([](const TimeJet& t) {
    const TimeJet s = drive(t, 2.0, 12.0, 0.5, 0.02);
    MotionJet m;
    m.x = s;
    m.y = s * 0.2;
    m.z = 1.2;
    m.yaw = 0.2;
    m.pitch = 0.02;
    m.roll = 0.01;
    return m;
  });
}

}  // namespace multicam_egomotion
