// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

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
};

/// Point in inverse-distance form about a constant origin: X = origin + direction / inverse_distance. Far points and
/// points at infinity are as well conditioned as near ones.
struct BundleLandmark {
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();      ///< odom [m], not estimated
  Eigen::Vector3d direction = Eigen::Vector3d::UnitX();  ///< unit, odom axes
  double inverse_distance = 0.0;                         ///< [1/m]
  std::vector<BundleObservation> observations;
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

/// Gaussian prior on some poses, linearized where it was made: 1/2 d^T H d - b^T d with d the local difference.
struct PosePrior {
  std::vector<int> poses;
  std::vector<BundlePose> linearization;
  Eigen::MatrixXd H;  ///< 6n x 6n
  Eigen::VectorXd b;
};

struct BundleOptions {
  bool fix_landmarks = false;  ///< estimate the poses against the landmarks as they are
  int max_iterations = 30;
  double relative_decrease = 1e-4;  ///< stop when the cost falls by less than this share
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

/// Levenberg-Marquardt over body poses and landmarks with the landmarks eliminated (Schur complement). Everything is
/// dense in the few poses of a window; no heap use beyond buffers that are kept.
class BundleAdjustment {
 public:
  std::vector<BundlePose> poses;
  std::vector<BundleLandmark> landmarks;
  std::vector<MotionFactor> factors;
  PosePrior prior;           ///< empty: the first pose is held fixed, unless the landmarks are
  double pixel_sigma = 0.5;  ///< image noise [px]

  BundleSummary solve(const BundleOptions& options);

  /// Normal equations of the poses at the present values (gradient form: H d = b), landmarks eliminated.
  /// `vision`: observations only; `rest`: factors and prior. Both 6n x 6n. Landmarks whose `use` is false are left out.
  void linearize(Eigen::MatrixXd* vision_H, Eigen::VectorXd* vision_b, Eigen::MatrixXd* rest_H, Eigen::VectorXd* rest_b,
                 const BundleOptions& options, const std::vector<char>* use = nullptr);

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
  struct LandmarkBlock {
    Eigen::Matrix3d H_inverse;
    Eigen::Vector3d b;
    int first_coupling = 0, coupling_count = 0;
  };
  struct Coupling {
    int pose;
    Eigen::Matrix<double, 6, 3> W;
  };

  void accumulateVision(double lambda, const BundleOptions& options, const std::vector<char>* use, Eigen::MatrixXd* H,
                        Eigen::VectorXd* b);
  void accumulateRest(Eigen::MatrixXd* H, Eigen::VectorXd* b) const;
  double cost(const BundleOptions& options) const;

  std::vector<LandmarkBlock> blocks_;
  std::vector<Coupling> couplings_;
  double weight_sum_ = 0.0, weight_square_sum_ = 0.0, weighted_squares_ = 0.0;
};

/// Local difference d with a ⊞ d = b: (dp, dtheta).
Eigen::Matrix<double, 6, 1> localDifference(const BundlePose& a, const BundlePose& b);
/// a ⊞ d.
BundlePose retract(const BundlePose& a, const Eigen::Matrix<double, 6, 1>& d);

}  // namespace multicam_egomotion
