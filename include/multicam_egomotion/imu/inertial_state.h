// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <vector>

#include "multicam_egomotion/geometry/covariance.h"
#include "multicam_egomotion/imu/imu_buffer.h"
#include "multicam_egomotion/imu/imu_calibration.h"
#include "multicam_egomotion/imu/imu_sample.h"

namespace multicam_egomotion {

struct InertialStateOptions {
  double gravity = 9.81;                   ///< [m/s^2]
  double initial_velocity_sigma = 5.0;     ///< per axis [m/s]
  double gyroscope_bias_sigma = 0.1;       ///< prior, per axis [rad/s]
  double accelerometer_bias_sigma = 0.15;  ///< prior, per axis [m/s^2]
  /// Added to the calibration's densities (root of the sum of squares): vibration, aliasing, time stamps.
  double gyroscope_noise_floor = 5e-4;      ///< [rad/s/sqrt(Hz)]
  double accelerometer_noise_floor = 0.02;  ///< [m/s^2/sqrt(Hz)]
  /// Scale and axis errors as a share of the rate, and of the acceleration other than gravity [1]; over
  /// `scale_error_time_s` such an error keeps its direction [s].
  double gyroscope_scale_sigma = 0.006;
  double accelerometer_scale_sigma = 0.01;
  double scale_error_time_s = 1.0;
  /// Error that all lengths of vision share because of its calibration [1]; 0: none is estimated.
  double length_sigma = 0.0;
  /// Constant scale error of the accelerometer, from data sheets of MEMS sensors [1]. It limits what can be learnt of
  /// the lengths.
  double accelerometer_lasting_scale_sigma = 0.005;
  /// Motion up to this frequency is expected. Straight lines between samples that are far apart shorten it [Hz].
  double motion_bandwidth_hz = 2.0;
  /// Unknown sustained acceleration of the platform beyond what the samples show, per axis [m/s^2].
  double motion_acceleration_sigma = 0.5;   ///< in motion
  double still_acceleration_sigma = 0.1;    ///< when the samples are as quiet as at rest
  double still_rate_spread = 0.01;          ///< quiet: standard deviation of each rate below this [rad/s]
  double still_acceleration_spread = 0.15;  ///< quiet: standard deviation of each acceleration below this [m/s^2]
  double still_rate_sigma = 0.005;          ///< quiet: the mean rate is the gyroscope bias to this [rad/s]
  /// Without velocity for this long the accelerometer's mean over that time is used as a weak vertical [s].
  double gravity_window_s = 1.0;
  /// Between samples further apart than this the motion is unseen: the velocity is taken to last, with the two
  /// uncertainties below; between closer ones these shrink with the square of their distance [s].
  double max_sample_gap_s = 0.5;
  double gap_rate_sigma = 0.5;          ///< rate unseen in a gap [rad/s]
  double gap_acceleration_sigma = 3.0;  ///< acceleration unseen in a gap [m/s^2]
  /// A correction rejected this many times in a row widens the covariance and is then accepted; one of the rotation
  /// then also widens the gyroscope's noise for some frames by what it disagrees (saturation, a broken sensor).
  int rejections_before_recovery = 3;
};

/// What happened to one kind of correction.
struct CorrectionCounts {
  std::uint64_t accepted = 0;
  std::uint64_t rejected = 0;    ///< by the chi-square gate (99.9 %)
  std::uint64_t invalid = 0;     ///< not finite, or a covariance that is not positive definite
  std::uint64_t recoveries = 0;  ///< covariance widened after repeated rejection
  int consecutive_rejections = 0;
  double squared_mahalanobis = 0.0;  ///< of the residual of the last that was valid, whether accepted or not
};

/// Attitude, velocity and biases of the IMU: error-state Kalman filter with the attitude at the last frame and the
/// displacement since then, so that vision's relative motion can correct it (stochastic cloning, Roumeliotis and
/// Burdick, ICRA 2002). Gravity comes from vision's velocity changes against the accelerometer.
///
/// Frames: odom has z up; the frame (index 1) is the IMU at markFrame(), now (index 2) the IMU at stamp().
/// Errors: R_true = Exp(δθ) R_odom_imu with δθ in odom axes, so yaw, which nothing observes, is one coordinate of the
/// error whatever the estimate; velocity in IMU axes, so that what vision measures is linear in the error.
///
/// Failure: nothing throws after construction. Input that is not finite, goes back in time or has no positive definite
/// covariance is counted and ignored.
class InertialState {
 public:
  /// Throws std::invalid_argument on an option or a noise density that is not positive.
  explicit InertialState(const ImuCalibration& calibration, const InertialStateOptions& options = {});

  /// Attitude from the samples before the first frame (0.1 s at least; 0.5 s or more is better), at their last stamp:
  /// the vertical is the mean specific force carried to the end by the gyroscope; yaw by levelAttitude of the body.
  /// The tilt covariance follows the spread of the force and its mismatch with gravity. Quiet samples also give the
  /// gyroscope bias. The velocity is 0 with `initial_velocity_sigma`: inertial sensors cannot tell rest from constant
  /// velocity. Biases known from before are kept. False, and nothing changes, if the samples are too few.
  /// `up`: the vertical at the last sample in IMU axes where something better than the force is known to start from;
  /// the covariance stays that of the force.
  bool initialize(const std::vector<ImuSample>& samples, const Eigen::Vector3d* up = nullptr);
  bool initialized() const { return initialized_; }
  /// The samples of initialize() were as quiet as at rest.
  bool startedStill() const { return started_still_; }

  /// Advances by one sample; ignored (counted) if not finite or not later than stamp().
  void propagate(const ImuSample& sample);
  /// Advances to `stamp_ns` with the samples of the buffer. Where they end early the rate (that of the last sample, or
  /// of vision since) and the velocity are held, with the uncertainty of a gap; the answer is then false.
  bool propagateTo(std::int64_t stamp_ns, const ImuBuffer& buffer);

  /// Makes now the frame: clones the attitude, sets the displacement to zero.
  void markFrame();

  /// Rotation of the IMU between frame and now from vision alone: R_1_2, covariance of δ in R_true = R_1_2 Exp(δ)
  /// (IMU axes now) [rad^2]. Answers whether it was accepted; so do the others.
  bool correctRelativeRotation(const Eigen::Matrix3d& R_1_2, const Eigen::Matrix3d& covariance);
  /// Displacement of the IMU between frame and now, in IMU axes of the frame [m]. Prefer it to correctVelocity for
  /// motion between images, which is a mean velocity, not the one now. `by_length`: the part of it that is longer by
  /// lengthError() than it truly is [m].
  bool correctDisplacement(const Eigen::Vector3d& p_1_2, const Eigen::Matrix3d& covariance,
                           const Eigen::Vector3d& by_length = Eigen::Vector3d::Zero());
  /// Velocity of the IMU now in IMU axes [m/s].
  bool correctVelocity(const Eigen::Vector3d& velocity, const Eigen::Matrix3d& covariance);
  /// Tilt of an external attitude estimate now; only the vertical of R_world_imu is used. Sigma per axis [rad].
  bool correctTilt(const Eigen::Matrix3d& R_world_imu, double sigma);

  /// Goes on at another time (clock jump, long outage): attitude and biases stay, `attitude_sigma` [rad] is added to
  /// each axis, velocity is 0 with its prior, and now is the frame.
  void restartAt(std::int64_t stamp_ns, double attitude_sigma);
  /// Adds what longer lengths may have changed everywhere: `other` is the same state where they were longer. Shares of
  /// how much longer they were, in standard deviations: `noise_share` has no other effect, `length_share` of it is
  /// lengthError(), which was taken for known.
  void addCommonError(const InertialState& other, double noise_share, double length_share);
  /// The next initialize() starts from the bias priors.
  void forgetBiases();

  std::int64_t stamp() const { return last_.stamp_ns; }                   ///< now [ns]
  std::int64_t frameStamp() const { return frame_stamp_ns_; }             ///< the frame [ns]
  const Eigen::Matrix3d& attitude() const { return R_odom_imu_; }         ///< R_odom_imu
  const Eigen::Matrix3d& frameAttitude() const { return R_odom_frame_; }  ///< R_odom_imu at the frame
  Eigen::Matrix3d attitudeCovariance() const;                             ///< of δθ, odom axes [rad^2]
  Eigen::Matrix3d frameAttitudeCovariance() const;                        ///< the same at the frame
  /// Roll and pitch: rotation about odom x and y [rad^2].
  Eigen::Matrix2d tiltCovariance() const;
  Eigen::Matrix2d frameTiltCovariance() const;
  /// Largest standard deviation of the tilt over its directions [rad].
  double tiltSigma() const;

  const Eigen::Vector3d& velocity() const { return v_odom_; }  ///< of the IMU in odom axes [m/s]
  Eigen::Matrix3d velocityCovariance() const;                  ///< in odom axes, attitude error included
  Eigen::Vector3d velocityInImuAxes() const;                   ///< [m/s]
  Eigen::Matrix3d velocityCovarianceInImuAxes() const;

  /// Rotation R_1_2 between frame and now. Its covariance is the gyroscope's alone, of δ in R_true = R_1_2 Exp(δ) (IMU
  /// axes now), with noise, bias covariance and scale error: take both before correcting with this frame's vision.
  Eigen::Matrix3d rotationSinceFrame() const;
  Eigen::Matrix3d rotationSinceFrameCovariance() const;
  /// Displacement of the IMU since the frame in IMU axes of the frame [m].
  const Eigen::Vector3d& displacementSinceFrame() const { return displacement_; }
  Eigen::Matrix3d displacementSinceFrameCovariance() const;

  const Eigen::Vector3d& gyroscopeBias() const { return gyroscope_bias_; }          ///< [rad/s]
  const Eigen::Vector3d& accelerometerBias() const { return accelerometer_bias_; }  ///< [m/s^2]
  /// By which share vision's lengths are too long, as far as the accelerometer can tell, and its standard deviation.
  double lengthError() const { return visionShare() * length_error_; }
  double lengthSigma() const;
  /// The same of what vision and accelerometer disagree about, whichever is wrong.
  double lengthDisagreement() const { return length_error_; }
  double lengthDisagreementSigma() const { return std::sqrt(covariance_(kLength, kLength)); }
  Eigen::Matrix3d gyroscopeBiasCovariance() const;
  Eigen::Matrix3d accelerometerBiasCovariance() const;
  /// Bias-corrected rate now, IMU axes [rad/s].
  Eigen::Vector3d angularVelocity() const { return last_.angular_velocity - gyroscope_bias_; }

  const CorrectionCounts& rotationCounts() const { return rotation_counts_; }
  const CorrectionCounts& velocityCounts() const { return velocity_counts_; }  ///< displacement and velocity
  const CorrectionCounts& tiltCounts() const { return tilt_counts_; }
  std::uint64_t ignoredSamples() const { return ignored_samples_; }

 private:
  static constexpr int kTheta = 0, kVelocity = 3, kGyroscopeBias = 6, kAccelerometerBias = 9, kFrameTheta = 12,
                       kDisplacement = 15, kLength = 18, kSize = 19;
  using Covariance = Eigen::Matrix<double, kSize, kSize>;
  using ErrorState = Eigen::Matrix<double, kSize, 1>;

  /// Mean of the specific force over a window of time, carried into one set of axes by the attitude.
  struct ForceWindow {
    double duration_s = 0.0;
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();           // ∫ R f dt
    double square_sum = 0.0;                                 // ∫ |f|² dt
    Eigen::Matrix3d rotation_sum = Eigen::Matrix3d::Zero();  // ∫ R dt
    void add(const Eigen::Matrix3d& R, const Eigen::Vector3d& force, double dt);
    double spread() const;
  };

  /// What the samples do not show of the motion over a step.
  struct Unseen {
    double rate_density = 0.0;   // variance of the rotation vector per time [rad^2/s]
    double force_density = 0.0;  // variance of the velocity per time [m^2/s^3]
    bool force = false;          // the samples say nothing of the acceleration
  };

  void propagate(const ImuSample& sample, double spacing_s);
  void hold(std::int64_t stamp_ns, std::int64_t latest_sample_ns);
  void advance(const ImuSample& sample, const Unseen& unseen);
  void step(const ImuSample& sample, const Unseen& unseen);
  /// Mean rate (IMU axes) and acceleration (odom axes) over dt, at the attitude R of its middle.
  void propagateCovariance(const Eigen::Vector3d& rate, const Eigen::Vector3d& acceleration, const Eigen::Matrix3d& R,
                           double dt, const Unseen& unseen);
  void doubtGyroscope(const Eigen::Vector3d& residual, bool recovered);
  void useGravityWindow();
  /// How far the window's mean force may be from gravity, per axis [m/s^2].
  double accelerationSigma(const ForceWindow& window, bool still) const;
  void correctVertical(const ForceWindow& window, double acceleration_sigma);
  bool correctMotion(const Eigen::Vector3d& residual, const Eigen::Matrix<double, 3, kSize>& H,
                     const Eigen::Matrix3d& covariance, double speed_residual);
  /// residual = H error + noise, with two or three rows.
  bool correct(const VectorRef& residual, const MatrixRef& H, const MatrixRef& noise, CorrectionCounts* counts,
               const ErrorState& widening, bool learn_accelerometer_bias = true);
  /// Of what vision and accelerometer disagree about in lengths, the share that is vision's.
  double visionShare() const;
  double accelerometerScaleSigma() const;
  /// Rotation to apply for the attitude error θ; turns the covariance of that block into the new axes.
  Eigen::Matrix3d turnError(const Eigen::Vector3d& theta, int block);
  void inject(const ErrorState& error);

  InertialStateOptions options_;
  Eigen::Matrix3d R_body_imu_;
  double gyroscope_variance_, accelerometer_variance_;            // densities squared, with the floor
  double gyroscope_walk_variance_, accelerometer_walk_variance_;  // densities squared

  bool initialized_ = false;
  bool started_still_ = false;
  ImuSample last_;
  std::int64_t frame_stamp_ns_ = 0;
  Eigen::Matrix3d R_odom_imu_ = Eigen::Matrix3d::Identity();
  Eigen::Matrix3d R_odom_frame_ = Eigen::Matrix3d::Identity();
  Eigen::Vector3d v_odom_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d gyroscope_bias_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d accelerometer_bias_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d displacement_ = Eigen::Vector3d::Zero();
  double length_error_ = 0.0;    // of vision against the accelerometer
  double sample_spacing_ = 0.0;  // mean of late [s]
  Covariance covariance_ = Covariance::Zero();
  Eigen::Matrix3d rotation_noise_ = Eigen::Matrix3d::Zero();          // gyroscope noise since the frame, axes now
  Eigen::Matrix3d rotation_bias_jacobian_ = Eigen::Matrix3d::Zero();  // of the rotation since the frame, axes now
  ForceWindow window_;                                                // since the last velocity
  bool held_ = false;                                                 // last_ is no sample
  bool force_seen_ = true;                                            // all the time since the frame
  std::int64_t rate_seen_ns_ = 0, velocity_seen_ns_ = 0;              // when vision last saw them [ns]
  double doubted_rate_density_ = 0;  // of a gyroscope that vision contradicts [rad^2/s]
  std::vector<ImuSample> scratch_;

  CorrectionCounts rotation_counts_, velocity_counts_, tilt_counts_;
  std::uint64_t ignored_samples_ = 0;
};

}  // namespace multicam_egomotion
