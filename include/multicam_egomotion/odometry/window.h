// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <map>
#include <vector>

#include "multicam_egomotion/estimation/bundle_adjustment.h"
#include "multicam_egomotion/odometry/ego_motion_result.h"
#include "multicam_egomotion/odometry/image_noise.h"
#include "multicam_egomotion/odometry/motion_summary.h"
#include "multicam_egomotion/odometry/rig_calibration.h"
#include "multicam_egomotion/tracking/tracked_frame.h"

namespace multicam_egomotion {

struct WindowOptions {
  int max_keyframes = 8;
  double keyframe_parallax_px = 15.0;  ///< median image motion since the last keyframe, rotation taken out [px]
  double keyframe_min_shared = 0.6;    ///< share of the tracks that the last keyframe saw too
  double initial_pixel_sigma = 0.5;    ///< image noise until it has been measured [px]
  double min_pixel_sigma = 0.1;        ///< [px]
  double max_pixel_sigma = 2.0;        ///< [px]
  double outlier_sigmas = 5.0;         ///< reprojection error from which an observation is an outlier
  double min_distance = 0.3;           ///< what seems to be nearer is a moving object [m]
  BundleOptions bundle;
};

/// Relative motion of the body between the last two frames with what is known of it.
struct RelativeMotion {
  Eigen::Isometry3d T_a_b = Eigen::Isometry3d::Identity();
  Matrix6d covariance = Matrix6d::Identity();  ///< as PoseWithCovariance
};

struct WindowEstimate {
  bool ok = false;
  Eigen::Isometry3d T_odom_previous = Eigen::Isometry3d::Identity();  ///< as re-estimated now
  Eigen::Isometry3d T_odom_body = Eigen::Isometry3d::Identity();
  Matrix6d covariance = Matrix6d::Zero();  ///< of T_odom_body, as PoseWithCovariance
  RelativeMotion relative;                 ///< from everything
  RelativeMotion vision;                   ///< from the images alone (contract 4)
  double lengthening = 1.0;                ///< factor by which the motions before are longer than they seemed
  double scale_sigma = 0.0;                ///< contract 7
  double scale_noise = 0.0;                ///< the part of it that comes of noise in the images
  ScaleState scale_state = ScaleState::kNotApplicable;
  Eigen::MatrixXd calibration_covariance;  ///< in the order of the calibration's unknowns
  double pixel_sigma = 0.0;
  double parallax_px = 0.0;  ///< since the last keyframe
  bool keyframe = false;
  std::vector<TrackId> inliers, outliers;  ///< tracks of the newest frame
};

/// Keyframes and the two newest frames with their observations; estimates their poses and the points jointly. A point
/// belongs to the keyframe that saw it first: when that leaves the window the point's information becomes part of a
/// prior on the remaining poses, and its track starts again, so no observation is used twice.
class Window {
 public:
  explicit Window(const WindowOptions& options, const RigCalibration& calibration = {});

  /// Starts anew with one keyframe at a known pose; what has been learnt of the calibration is kept.
  void start(std::int64_t stamp_ns, const Eigen::Isometry3d& T_odom_body, const Matrix6d& covariance,
             const TrackedFrame& frame, const std::vector<Eigen::Isometry3d>& T_body_cam);
  bool empty() const { return states_.empty(); }

  /// Adds the newest frame (inlier observations only) and estimates. `guesses`: candidate motions from the previous
  /// frame, the best is refined. When it fails (`ok` false) the caller starts the window anew.
  WindowEstimate add(const TrackedFrame& frame, const std::vector<Eigen::Isometry3d>& T_body_cam,
                     const MotionSummary& motion, const std::vector<Eigen::Isometry3d>& guesses);

  /// Turns everything by R (odom axes) about `pivot`: a correction of gravity (contract 5).
  void rotateAbout(const Eigen::Vector3d& pivot, const Eigen::Matrix3d& R);

  /// Makes all lengths `factor` times as long about the newest body position: of motions and points, and the distances
  /// between the cameras, which are placed from `first_camera` on (body axes [m]). The views fit as before.
  void scale(double factor, const Eigen::Vector3d& first_camera);
  /// Of all lengths, by what is not estimated of the calibration; that of the rig file until it is set [1].
  void setLengthSigma(double sigma) { length_sigma_ = sigma; }

  /// Triangulated points in odom with a distance known to better than 20 % [m].
  std::vector<Eigen::Vector3d> points() const;
  /// Those that the newest frame does not see, in its body frame.
  std::vector<TrackedPoint> unseen() const;
  double pixelSigma() const { return noise_.pixelSigma(); }
  /// What the views so far say of the cameras, with the prior of the rig file.
  const BundleCalibration& calibration() const { return calibration_; }
  /// Its covariance, in the order of its unknowns [rad, px].
  const Eigen::MatrixXd& calibrationCovariance() const { return calibration_covariance_; }

 private:
  struct State {
    std::int64_t stamp_ns = 0;
    BundlePose pose;
    MotionSummary from_previous;
    bool keyframe = false;
  };

  struct Landmark : BundleLandmark {
    int frames = 0;  ///< that have seen it
  };

  void addObservations(const TrackedFrame& frame, const std::vector<Eigen::Isometry3d>& T_body_cam);
  void initializeLandmarks();
  BundlePose alignedNewest(const std::vector<Eigen::Isometry3d>& guesses) const;
  bool seemsAtRest() const;
  void dropMoving(WindowEstimate* estimate);
  bool distanceIsKnown(const BundleLandmark& landmark) const;
  bool seenInNewest(const BundleLandmark& landmark) const;
  double errorInNewest(const BundleLandmark& landmark) const;
  void optimize(WindowEstimate* estimate);
  bool solve(WindowEstimate* estimate);
  double lengthening(const BundleAdjustment& bundle) const;
  void classify(WindowEstimate* estimate);
  bool wantsKeyframe(WindowEstimate* estimate) const;
  void dropState(int index);
  void marginalizeOldest();
  std::vector<int> landmarksAcross() const;
  BundleAdjustment makeBundle(std::vector<TrackId>* tracks) const;
  BundlePrior calibrationAlone() const;

  WindowOptions options_;
  RigCalibration rig_calibration_;
  BundleCalibration calibration_;
  Eigen::MatrixXd calibration_covariance_;
  double length_sigma_;
  ImageNoise noise_;
  bool newcomers_wait_ = false;  ///< tracks of few frames, none a keyframe, have no say in the pose
  std::vector<State> states_;    ///< keyframes, oldest first; then the previous frame if it is none, then the newest
  std::map<TrackId, Landmark> landmarks_;
  BundlePrior prior_;
  /// Pose where the window started and its covariance, which stays outside: with a weak prior the small errors of
  /// linearization that marginalization leaves would move the whole window.
  RelativeMotion start_;
};

}  // namespace multicam_egomotion
