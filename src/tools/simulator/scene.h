// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <memory>
#include <vector>

#include "simulator/texture.h"

namespace multicam_egomotion {

/// Where a ray meets the scene.
struct SceneHit {
  double distance = 0.0;  ///< along the unit direction [m]; infinite for the sky
  int surface = -1;       ///< 6 * box + face, -1 for the sky
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
};

/// Upright textured boxes in a z-up world. The first is the hall: it is seen from inside.
class Scene {
 public:
  struct Box {
    Eigen::Vector3d center;     ///< [m]
    Eigen::Vector3d half_size;  ///< [m]
    double yaw = 0.0;           ///< about z [rad]
  };

  /// `open_sky`: the hall has no ceiling, and rays that leave through it see a bright sky.
  Scene(const Box& hall, const std::vector<Box>& boxes, bool open_sky, std::uint64_t seed);

  /// First surface along a ray from inside the hall; `direction` unit.
  SceneHit castRay(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) const;
  /// The same among the boxes of `candidates` and the hall.
  SceneHit castRay(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
                   const std::vector<int>& candidates) const;

  /// Boxes (hall excluded) that may be seen inside the cone of `half_angle` [rad] about `axis` (unit).
  void boxesInCone(const Eigen::Vector3d& origin, const Eigen::Vector3d& axis, double half_angle,
                   std::vector<int>* boxes) const;

  /// Grey value (0 to 255) of a surface at `point`, averaged over the parallelogram of the two edges [m].
  float shade(const SceneHit& hit, const Eigen::Vector3d& point, const Eigen::Vector3d& edge_u,
              const Eigen::Vector3d& edge_v) const;

  const std::vector<Box>& boxes() const { return boxes_; }

 private:
  struct Surface {
    float cos_turn, sin_turn;  // of the texture on the face
    float shift_u, shift_v;    // [m]
    float brightness;
    int fine, coarse;  // textures
  };
  struct Frame {
    double cos_yaw, sin_yaw, radius;
  };

  bool open_sky_;
  std::vector<Box> boxes_;
  std::vector<Frame> frames_;
  std::vector<int> all_boxes_;  // without the hall
  std::vector<Surface> surfaces_;
  std::vector<std::shared_ptr<const Texture>> textures_;
};

}  // namespace multicam_egomotion
