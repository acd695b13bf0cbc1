// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "simulator/planar_path.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace multicam_egomotion {

namespace {

TimeJet headingAlong(const PlanarPath::Segment& segment, const TimeJet& s) {
  return smoothStep(s * (1.0 / segment.length)) * segment.angle;
}

}  // namespace

PlanarPath::PlanarPath(std::vector<Segment> segments) : segments_(std::move(segments)) {
  Node node{0.0, 0.0, 0.0, 0.0};
  nodes_.push_back(node);
  for (const Segment& segment : segments_) {
    if (!(segment.length > 0.0)) throw std::invalid_argument("PlanarPath: segment length must be positive");
    const Local end = integrate(node, segment, segment.length);
    node = {node.s + segment.length, end.x, end.y, node.heading + segment.angle};
    nodes_.push_back(node);
  }
}

PlanarPath::Local PlanarPath::integrate(const Node& start, const Segment& segment, double length) const {
  // Gauss-Legendre with 5 nodes a metre: far below a nanometre for turns of more than a metre.
  static const double kNodes[5] = {0.0, 0.5384693101056831, -0.5384693101056831, 0.9061798459386640,
                                   -0.9061798459386640};
  static const double kWeights[5] = {0.5688888888888889, 0.4786286704993665, 0.4786286704993665, 0.2369268850561891,
                                     0.2369268850561891};
  const int steps = segment.angle == 0.0 ? 1 : static_cast<int>(std::ceil(segment.length));
  const double whole = segment.angle == 0.0 ? segment.length : segment.length / steps;
  Local p{start.x, start.y};
  for (double from = 0.0; from < length; from += whole) {
    const double half = 0.5 * std::min(whole, length - from);
    for (int i = 0; i < 5; ++i) {
      const double heading = start.heading + headingAlong(segment, TimeJet(from + half * (1.0 + kNodes[i]))).value;
      p.x += half * kWeights[i] * std::cos(heading);
      p.y += half * kWeights[i] * std::sin(heading);
    }
  }
  return p;
}

PlanarPath::Point PlanarPath::at(const TimeJet& s) const {
  // Whole laps first; the end of a lap becomes the start of the next.
  const Node& lap = nodes_.back();
  const double laps = std::floor(s.value / lap.s);
  double x = 0.0, y = 0.0, heading = 0.0;
  for (int i = 0; i < std::abs(static_cast<int>(laps)); ++i) {
    if (laps > 0) {
      x += std::cos(heading) * lap.x - std::sin(heading) * lap.y;
      y += std::sin(heading) * lap.x + std::cos(heading) * lap.y;
      heading += lap.heading;
    } else {
      heading -= lap.heading;
      x -= std::cos(heading) * lap.x - std::sin(heading) * lap.y;
      y -= std::sin(heading) * lap.x + std::cos(heading) * lap.y;
    }
  }
  const double in_lap = s.value - laps * lap.s;
  std::size_t k = 0;
  while (k + 1 < segments_.size() && in_lap >= nodes_[k + 1].s) ++k;
  const TimeJet along = s - (laps * lap.s + nodes_[k].s);
  const Local local = integrate(nodes_[k], segments_[k], along.value);

  Point point;
  point.heading = headingAlong(segments_[k], along) + (nodes_[k].heading + heading);
  const TimeJet c = cos(point.heading), n = sin(point.heading);
  // dp/dt = (cos, sin) ds/dt; once more for the acceleration.
  point.x = {x + std::cos(heading) * local.x - std::sin(heading) * local.y, c.value * s.rate,
             c.rate * s.rate + c.value * s.acceleration};
  point.y = {y + std::sin(heading) * local.x + std::cos(heading) * local.y, n.value * s.rate,
             n.rate * s.rate + n.value * s.acceleration};
  return point;
}

}  // namespace multicam_egomotion
