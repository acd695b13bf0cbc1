// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "multicam_egomotion/geometry/camera_rig.h"
#include "multicam_egomotion/tracking/frame_set.h"

namespace multicam_egomotion {

struct ImageMonitorOptions {
  double dark_mean = 12.0;           ///< mean grey level below which a picture is dark [0 to 255]
  int saturated_level = 250;         ///< grey level from which a pixel is saturated
  double saturated_share = 0.5;      ///< share of saturated pixels from which a picture is
  double least_contrast = 3.0;       ///< standard deviation of the grey levels below which a picture shows nothing
  int images_until_named = 3;        ///< in a row, before dark, saturated or without contrast is a fault
  double moving_rotation = 0.00873;  ///< a body that turned by this much sees another picture [rad]
  double frozen_s = 3.0;  ///< the same picture for so long is named even if nothing else tells that the body moves [s]
};

/// Motion of the body since the last frame as predicted without the images.
struct ExpectedMotion {
  Eigen::Vector3d rotation = Eigen::Vector3d::Zero();  ///< rotation vector [rad]
  double rotation_sigma = 0.0;                         ///< [rad]
  bool translation = false;                            ///< surely some
  double duration_s = 0.0;
};

/// Looks at the pictures themselves: wrong size, dark, saturated, without contrast, or the same one again and again.
/// An image that cannot be what the camera sees now is treated as missing; everything else is only named.
class ImageMonitor {
 public:
  explicit ImageMonitor(const CameraRig& rig, const ImageMonitorOptions& options = {});

  /// False, and counted, if the image is not of its camera's size. Without pixels or a known camera: true.
  bool fits(const CameraImage& image);

  /// Takes those images out of the set that repeat the pixels of the one before although the body has moved since: by
  /// the motion expected, or, from the third on, because another camera sees change. In a set that becomes empty the
  /// expected motion goes on to accumulate.
  void takeOutFrozen(const ExpectedMotion& motion, FrameSet* set);

  /// One line for each fault that the newest images show, such as "cam1: image is 320x240, expected 160x120".
  std::vector<std::string> faults() const;
  /// The newest image of a camera has the right size.
  bool rightSize(int camera) const { return cameras_[camera].found_size == cameras_[camera].size; }
  std::uint64_t wrongSizes() const { return wrong_sizes_; }  ///< images, since the start

  /// Forgets the pictures, as after a jump of the clock.
  void reset();

 private:
  struct Camera {
    std::string name;
    cv::Size size, found_size;
    std::uint64_t hash = 0;
    int images_of_picture = 0;           ///< with the pixels of the newest, that included
    std::int64_t picture_since_ns = 0;   ///< stamp of the first of these
    std::int64_t picture_newest_ns = 0;  ///< and of the newest
    /// Of the body meanwhile, up to the last frame, over about a second: longer, the bias' error would add up [rad].
    Eigen::Vector3d rotation = Eigen::Vector3d::Zero();
    double rotation_sigma = 0.0;
    bool frozen = false;
    int dark = 0, saturated = 0, flat = 0;  ///< images in a row
  };

  void look(const CameraImage& image, Camera* camera) const;
  bool hasMoved(const Camera& camera, const ExpectedMotion& motion) const;

  ImageMonitorOptions options_;
  std::vector<Camera> cameras_;
  std::uint64_t wrong_sizes_ = 0;
};

}  // namespace multicam_egomotion
