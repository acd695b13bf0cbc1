// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "simulator/time_jet.h"

namespace multicam_egomotion {

/// Path of a vehicle in the plane: straights and smooth turns, repeated for ever. The heading is the tangent.
class PlanarPath {
 public:
  struct Segment {
    double length;  ///< [m]
    double angle;   ///< heading gained over the segment [rad], smooth at both ends; 0 for a straight
  };
  struct Point {
    TimeJet x, y;     ///< [m]
    TimeJet heading;  ///< [rad]
  };

  explicit PlanarPath(std::vector<Segment> segments);

  /// Point at arc length s(t) [m]; any s.
  Point at(const TimeJet& s) const;

 private:
  struct Node {
    double s, x, y, heading;  ///< at the start of a segment
  };
  struct Local {
    double x, y;
  };
  Local integrate(const Node& start, const Segment& segment, double length) const;

  std::vector<Segment> segments_;
  std::vector<Node> nodes_;  ///< one a segment, and the end of a lap
};

}  // namespace multicam_egomotion
