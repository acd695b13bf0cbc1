// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "multicam_egomotion/imu/imu_calibration.h"
#include "multicam_egomotion/imu/inertial_state.h"
#include "multicam_egomotion/odometry/ego_motion_result.h"
#include "multicam_egomotion/odometry/window.h"

namespace multicam_egomotion {

/// What is known of the body's motion without the images: predicts from frame to frame and learns from vision.
/// Two kinds: InertialMotion (IMU) and ConstantRateMotion (none, contract 9).
class MotionModel {
 public:
  virtual ~MotionModel() = default;

  virtual bool initialized() const = 0;
  /// Takes its start at `stamp_ns`; false while there is not enough to start from.
  virtual bool initialize(std::int64_t stamp_ns) = 0;
  /// Goes to `stamp_ns`, later than before.
  virtual void advanceTo(std::int64_t stamp_ns) = 0;
  virtual std::int64_t stamp() const = 0;

  /// Motion of the body since the last frame, without vision.
  virtual MotionSummary motionSinceFrame() const = 0;
  /// Learns from the motion that the images alone say (contract 4); displacement only if `scale_seen`.
  virtual void correct(const RelativeMotion& vision, bool scale_seen) = 0;
  /// Makes now the frame.
  virtual void markFrame() = 0;

  /// Direction of the vertical in body axes (unit), now and at the last frame.
  virtual Eigen::Vector3d up() const = 0;
  virtual Eigen::Vector3d upAtFrame() const = 0;
  virtual double tiltSigma() const = 0;  ///< per axis [rad]
  virtual TwistWithCovariance twist() const = 0;
  /// By which share lengths are too long that vision measures with the rig file's distances between cameras; nothing
  /// where the images alone know lengths.
  virtual double lengthError() const { return 0.0; }
  virtual std::optional<double> lengthSigma() const { return std::nullopt; }
  virtual Eigen::Vector3d gyroscopeBias() const { return Eigen::Vector3d::Zero(); }
  virtual Eigen::Vector3d accelerometerBias() const { return Eigen::Vector3d::Zero(); }

  /// Goes on at another time (clock jump): velocity is forgotten, `attitude_sigma` [rad] is added.
  virtual void restartAt(std::int64_t stamp_ns, double attitude_sigma) = 0;
  /// Start anew; biases are kept unless `forget_biases`.
  virtual void reset(bool forget_biases) = 0;
};

/// From gyroscope and accelerometer through InertialState, moved to the body with the lever arm. Frames that samples
/// do not reach are bridged; when the samples come, up to a second late, all is done again with them. So is a start in
/// motion, when vision has shown that the accelerometer was far off the vertical, or how long the motions were.
class InertialMotion : public MotionModel {
 public:
  /// `tilt_from_message`: the vertical comes from the samples' orientation as well (contract 9). `time_sigma`: of the
  /// IMU's stamps against the images' [s]. `first_camera`: its centre in the body; an error of lengths is one of its
  /// displacement [m].
  InertialMotion(const ImuCalibration& calibration, const InertialStateOptions& options, const ImuBuffer* buffer,
                 bool tilt_from_message, double time_sigma = 0.0,
                 const Eigen::Vector3d& first_camera = Eigen::Vector3d::Zero());

  bool initialized() const override { return initialized_; }
  bool initialize(std::int64_t stamp_ns) override;
  void advanceTo(std::int64_t stamp_ns) override;
  std::int64_t stamp() const override { return state_.stamp(); }
  MotionSummary motionSinceFrame() const override;
  void correct(const RelativeMotion& vision, bool scale_seen) override;
  /// After correct(): what the window says of the last motion and of the length of those before. Scale that is found
  /// late has looked like an acceleration until then; the start is made again with the lengths that are known now.
  void reviseStart(const WindowEstimate& estimate);
  void markFrame() override;
  Eigen::Vector3d up() const override;
  Eigen::Vector3d upAtFrame() const override;
  double tiltSigma() const override { return state_.tiltSigma(); }
  TwistWithCovariance twist() const override;
  double lengthError() const override { return state_.lengthError(); }
  std::optional<double> lengthSigma() const override { return state_.lengthSigma(); }
  Eigen::Vector3d gyroscopeBias() const override { return state_.gyroscopeBias(); }
  Eigen::Vector3d accelerometerBias() const override { return state_.accelerometerBias(); }
  /// Between the displacements seen in the last 60 frames or so and those that the accelerometer expected: mean of
  /// their squared Mahalanobis distances, each counted as 20 at most. 3 where both are as good as they say, less where
  /// better.
  double contradiction() const { return contradiction_; }
  void restartAt(std::int64_t stamp_ns, double attitude_sigma) override;
  void reset(bool forget_biases) override;

 private:
  /// What vision said at a frame.
  struct Frame {
    std::int64_t stamp_ns = 0;
    std::optional<RelativeMotion> vision;
    bool scale_seen = false;
    std::optional<RelativeMotion> measured;  // by the window, of the length that is known by now; where it moved
  };

  /// What the start was made from, to make it again.
  struct Start {
    InertialState before;
    std::vector<ImuSample> samples;
    std::vector<Frame> frames;      // since then
    Eigen::Matrix3d R_start_frame;  // from the last of the samples
    Eigen::Vector3d up;             // taken there, IMU axes
    double tilt_sigma;              // of what the force told [rad]
    double scale_sigma = 0.0;       // worst of the lengths that the state has been made from
    bool measured = false;          // they were those of the window
  };

  void startFromVertical();
  void makeStartAnew(const Eigen::Vector3d& up);
  void replayStart(const Eigen::Vector3d& up, double lengthening);
  void learn(const RelativeMotion& vision, bool scale_seen, bool learn_length = true);
  void takeTiltFromMessage();
  Eigen::Matrix3d alignmentCovariance() const;
  void propagateTo(std::int64_t stamp_ns);
  void catchUp();
  void startFromHere();

  ImuCalibration calibration_;
  InertialState state_;
  double contradiction_ = 0.0;
  const ImuBuffer* buffer_;
  bool tilt_from_message_;
  double time_sigma_;
  Eigen::Vector3d first_camera_;
  Eigen::Vector3d rate_at_frame_ = Eigen::Vector3d::Zero();  // IMU axes of the frame [rad/s]
  bool initialized_ = false;

  InertialState complete_;               // at the last frame that the samples reached
  std::vector<Frame> bridged_;           // the frames since then
  Frame newest_;                         // not yet marked
  bool samples_were_short_ = false;      // since complete_
  std::optional<Start> start_;           // while it may be made again
  std::optional<Start> complete_start_;  // the same at complete_
};

/// Goes on turning and moving as between the last two frames; the vertical is carried by visual rotation.
class ConstantRateMotion : public MotionModel {
 public:
  /// `rotation_sigma`: of the rotation between two frames [rad]; `velocity_sigma`: when nothing is known [m/s].
  ConstantRateMotion(double rotation_sigma, double velocity_sigma);

  bool initialized() const override { return initialized_; }
  bool initialize(std::int64_t stamp_ns) override;
  void advanceTo(std::int64_t stamp_ns) override { stamp_ns_ = stamp_ns; }
  std::int64_t stamp() const override { return stamp_ns_; }
  MotionSummary motionSinceFrame() const override;
  void correct(const RelativeMotion& vision, bool scale_seen) override;
  void markFrame() override { frame_stamp_ns_ = stamp_ns_; }
  Eigen::Vector3d up() const override { return up_; }
  Eigen::Vector3d upAtFrame() const override { return up_at_frame_; }
  double tiltSigma() const override;
  TwistWithCovariance twist() const override { return twist_; }
  void restartAt(std::int64_t stamp_ns, double attitude_sigma) override;
  void reset(bool forget_biases) override;

 private:
  double seconds() const { return 1e-9 * static_cast<double>(stamp_ns_ - frame_stamp_ns_); }

  double rotation_sigma_, velocity_sigma_;
  bool initialized_ = false;
  std::int64_t stamp_ns_ = 0, frame_stamp_ns_ = 0;
  Eigen::Vector3d up_ = Eigen::Vector3d::UnitZ(), up_at_frame_ = Eigen::Vector3d::UnitZ();
  TwistWithCovariance twist_;
};

}  // namespace multicam_egomotion
