// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <string>
#include <vector>

#include "multicam_egomotion/estimation/scale_observability.h"
#include "multicam_egomotion/tracking/tracked_frame.h"

namespace multicam_egomotion {

using Matrix6d = Eigen::Matrix<double, 6, 6>;

enum class EgoMotionStatus { kInitializing, kTracking, kCoasting, kLost };

const char* name(EgoMotionStatus status);
const char* name(ScaleState state);

/// A rigid motion with its covariance. Order x y z, rx ry rz [m, rad]; the position part is additive in the axes of the
/// parent frame, the rotation part is R_true = Exp(dtheta) R (contract 10).
struct PoseWithCovariance {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  Matrix6d covariance = Matrix6d::Zero();
};

struct TwistWithCovariance {
  Eigen::Vector3d linear = Eigen::Vector3d::Zero();   ///< velocity of the body origin in body axes [m/s]
  Eigen::Vector3d angular = Eigen::Vector3d::Zero();  ///< in body axes [rad/s]
  Matrix6d covariance = Matrix6d::Zero();             ///< linear, angular; body axes
};

/// What the images say of one camera beside the rig file.
struct CameraCalibration {
  int camera = 0;
  Eigen::Vector3d rotation = Eigen::Vector3d::Zero();    ///< d in R_body_cam = that of the rig file * Exp(d) [rad]
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< of d, as far as errors of the images differ [rad^2]
  bool overlaps = false;         ///< with a camera before it; only then the two below are estimated
  double focal_length = 0.0;     ///< longer than in the rig file, against that other camera's, as a share [1]
  double static_error_px = 0.0;  ///< across the epipolar lines to another camera, RMS over the image [px]
};

/// A feature of the newest frame as it was used, for pictures and diagnostics.
struct FeatureReport {
  TrackId track = 0;
  int camera = 0;
  Eigen::Vector2d pixel;
  Eigen::Vector2d previous_pixel;  ///< equal to pixel for a new feature
  bool inlier = false;             ///< used by the estimate
  bool is_new = true;
};

/// What the odometry says of one frame set (or of one coast tick).
struct EgoMotionResult {
  std::int64_t stamp_ns = 0;           ///< reference stamp of the frame set; IMU time for a coast tick
  std::int64_t previous_stamp_ns = 0;  ///< 0 for the first frame of an odom epoch
  EgoMotionStatus status = EgoMotionStatus::kInitializing;
  bool has_relative_pose = false;  ///< false for the first frame and for coast ticks
  bool has_pose = false;           ///< false once LOST

  PoseWithCovariance T_odom_body;      ///< accumulated pose, covariance in odom axes
  PoseWithCovariance T_previous_body;  ///< body(t2) in body(t1), covariance in the axes of body(t1)
  TwistWithCovariance twist;           ///< at stamp_ns
  Eigen::Vector3d gyroscope_bias = Eigen::Vector3d::Zero();      ///< [rad/s]
  Eigen::Vector3d accelerometer_bias = Eigen::Vector3d::Zero();  ///< [m/s^2]
  /// Against gravity, unit, in body axes: all that is known of the vertical by now, which the attitude of odom follows
  /// slowly (contract 5).
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  double tilt_sigma = 0.0;  ///< of `up`, per axis [rad]

  ScaleState scale_state = ScaleState::kNotApplicable;
  double scale_sigma = 0.0;  ///< relative, contract 7; infinite when nothing is seen of it
  bool keyframe = false;
  std::uint32_t odom_epoch = 0;
  std::string solver;  ///< "4pt-vertical", "4pt-axis", or empty

  int tracks = 0;  ///< correspondences offered to RANSAC
  int inliers = 0;
  int ransac_samples = 0;
  double pixel_sigma = 0.0;  ///< estimated image noise [px]

  std::vector<FeatureReport> features;
  std::vector<Eigen::Vector3d> points;        ///< triangulated landmarks of the window in odom [m]
  std::vector<std::int64_t> image_stamps_ns;  ///< per camera of the rig, 0 where the image was missing
};

}  // namespace multicam_egomotion
