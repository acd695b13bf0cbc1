// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "multicam_egomotion/estimation/bundle_calibration.h"
#include "multicam_egomotion/geometry/camera_rig.h"

namespace multicam_egomotion {

/// Body pose in odom; perturbed locally: R <- R Exp(dtheta), p <- p + R dp. A pose's six unknowns are (dp, dtheta).
struct BundlePose {
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  Eigen::Vector3d p = Eigen::Vector3d::Zero();  ///< [m]
};

/// One camera's view of a landmark, expressed in body axes so that the cameras need not appear here.
struct BundleObservation {
  int pose = 0;                          ///< index into the poses
  int camera = 0;                        ///< index in the rig
  Eigen::Vector3d bearing;               ///< unit, body axes
  Eigen::Vector3d center;                ///< camera centre in the body frame at the reference stamp [m]
  Eigen::Matrix<double, 2, 3> to_pixel;  ///< pixel error of a predicted point x (body axes, from the centre) is
                                         ///< to_pixel * x / (bearing · x) [px]
  Eigen::Vector2d across = Eigen::Vector2d::Zero();  ///< unit vector across the epipolar lines [px]; 0: no field here
  Eigen::Vector2d image_position = Eigen::Vector2d::Zero();  ///< for fieldTerms()
  Eigen::Vector2d from_center = Eigen::Vector2d::Zero();     ///< pixel from the principal point [px]
};

/// Point in inverse-distance form about a constant origin: X = origin + direction / inverse_distance. Far points and
/// points at infinity are as well conditioned as near ones.
struct BundleLandmark {
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();      ///< odom [m], not estimated
  Eigen::Vector3d direction = Eigen::Vector3d::UnitX();  ///< unit, odom axes
  double inverse_distance = 0.0;                         ///< [1/m]
  std::vector<BundleObservation> observations;
  /// Error that all views of one camera have in common, against those of the camera of the first view [px]: the patches
  /// of two cameras do not look alike. By camera.
  std::array<Eigen::Vector2d, CameraRig::kMaxCameras> offsets = noOffsets();

  static std::array<Eigen::Vector2d, CameraRig::kMaxCameras> noOffsets();
};

/// What is known of the motion between two poses without vision: gyroscope rotation and, where vision sees no scale,
/// the displacement predicted from the velocity.
struct MotionFactor {
  int pose_a = 0, pose_b = 0;
  Eigen::Matrix3d R_a_b = Eigen::Matrix3d::Identity();
  Eigen::Matrix3d rotation_information = Eigen::Matrix3d::Zero();     ///< of Log(R_a_b^T R_a^T R_b) [1/rad^2]
  Eigen::Vector3d p_b_a = Eigen::Vector3d::Zero();                    ///< position of b in the axes of a [m]
  Eigen::Matrix3d translation_information = Eigen::Matrix3d::Zero();  ///< [1/m^2], zero when not used
};

/// Gaussian prior on some poses and the calibration, linearized where it was made: 1/2 d^T H d - b^T d with d the local
/// difference of the poses and then the calibration.
struct BundlePrior {
  std::vector<int> poses;
  std::vector<BundlePose> linearization;
  BundleCalibration calibration;
  Eigen::MatrixXd H;  ///< square of the size of d
  Eigen::VectorXd b;

  bool empty() const { return H.size() == 0; }
  Eigen::VectorXd difference(const std::vector<BundlePose>& all_poses, const BundleCalibration& now) const;
};

struct BundleOptions {
  bool fix_landmarks = false;  ///< estimate the poses against the landmarks as they are
  int max_iterations = 30;
  double relative_decrease = 2e-3;  ///< stop when the cost falls by less than this share
  /// Points are not much nearer than this: sigma of a prior on the inverse distance about 0 [1/m]. It keeps points that
  /// are seen without parallax from taking any distance, and says next to nothing of the scale.
  double inverse_distance_sigma = 3.0;
  double robust_width = 2.0;  ///< residual, in image sigmas, from which an observation is down-weighted (Cauchy)
};

struct BundleSummary {
  int iterations = 0;
  double cost = 0.0;
  double weighted_square_sum = 0.0;  ///< robustly weighted squared pixel errors in units of the image noise
  double degrees_of_freedom = 0.0;   ///< weighted residuals minus unknowns
  bool finite = true;
};

/// Levenberg-Marquardt over body poses, calibration and landmarks with the landmarks eliminated (Schur complement).
/// The unknowns are the poses, six each, and after them the calibration; a considered part of that has its columns in
/// the normal equations, but is not moved. Everything is dense in the few poses of a
/// window; no heap use beyond buffers that are kept.
class BundleAdjustment {
 public:
  std::vector<BundlePose> poses;
  BundleCalibration calibration;
  std::vector<BundleLandmark> landmarks;
  std::vector<MotionFactor> factors;
  BundlePrior prior;          ///< empty: the first pose is held fixed, unless the landmarks are
  double pixel_sigma = 0.5;   ///< image noise [px]
  double offset_sigma = 0.0;  ///< of the landmarks' offsets [px]; 0: there are none

  BundleSummary solve(const BundleOptions& options);

  /// Normal equations at the present values (gradient form: H d = b), landmarks eliminated.
  /// `vision`: observations only; `rest`: factors and prior.
  void linearize(Eigen::MatrixXd* vision_H, Eigen::VectorXd* vision_b, Eigen::MatrixXd* rest_H, Eigen::VectorXd* rest_b,
                 const BundleOptions& options);

  /// Poses and calibration, what is considered included.
  int size() const { return firstOfCalibration() + calibration.size(); }
  int firstOfCalibration() const { return 6 * static_cast<int>(poses.size()); }
  /// Makes what is considered stay as it is in the solution of H d = b.
  void holdConsidered(Eigen::MatrixXd* H, Eigen::VectorXd* b) const;

  /// Factor by which a Newton step of the last linearization is longer than H^-1 b: reweighting takes the Cauchy loss
  /// for more curved than it is.
  double newtonGain() const { return weight_square_sum_ > 0.0 ? weight_sum_ / weight_square_sum_ : 1.0; }

  /// Pixel error of an observation [px]; false when the point is behind the camera.
  /// `by_inverse_distance`: its derivative by the landmark's inverse distance [px m], optional.
  bool error(const BundleLandmark& landmark, const BundleObservation& observation, Eigen::Vector2d* error_px,
             Eigen::Vector2d* by_inverse_distance = nullptr) const;
  /// Its norm in image sigmas; negative when the point is behind the camera.
  double normalizedError(const BundleLandmark& landmark, const BundleObservation& observation) const;

 private:
  /// Rows of one pose or of one camera's calibration in the unknowns, and where their part of a landmark stands.
  struct Segment {
    int column, rows, at;
  };
  /// What is left of an eliminated landmark: L y of its normal equations H_l = L L^T, b_l = L y, and for each segment
  /// A = W L^-T; all in values_.
  struct LandmarkBlock {
    int depth = 0;  ///< its unknowns: 3, and 2 for each further camera's offset
    int first_segment = 0, segment_count = 0;
    int L = 0, y = 0;
  };

  int furtherCameras(const BundleLandmark& landmark, std::array<int, CameraRig::kMaxCameras>* offset_of) const;
  template <int Depth>
  void accumulateLandmark(const BundleLandmark& landmark, const int* offset_of, double lambda,
                          const BundleOptions& options, Eigen::MatrixXd* H, Eigen::VectorXd* b, LandmarkBlock* block);
  void accumulateAgainstFixed(const BundleOptions& options, Eigen::MatrixXd* H, Eigen::VectorXd* b);
  void accumulateVision(double lambda, const BundleOptions& options, Eigen::MatrixXd* H, Eigen::VectorXd* b);
  void accumulateRest(Eigen::MatrixXd* H, Eigen::VectorXd* b) const;
  void moveLandmarks(const Eigen::VectorXd& step);
  double cost(const BundleOptions& options) const;

  std::vector<LandmarkBlock> blocks_;
  std::vector<Segment> segments_;
  std::vector<double> values_;
  double weight_sum_ = 0.0, weight_square_sum_ = 0.0, weighted_squares_ = 0.0;
  double landmark_unknowns_ = 0.0;  ///< offsets count by how far the observations and not their prior determine them
};

/// Local difference d with a ⊞ d = b: (dp, dtheta).
Eigen::Matrix<double, 6, 1> localDifference(const BundlePose& a, const BundlePose& b);
/// a ⊞ d.
BundlePose retract(const BundlePose& a, const Eigen::Matrix<double, 6, 1>& d);

}  // namespace multicam_egomotion
