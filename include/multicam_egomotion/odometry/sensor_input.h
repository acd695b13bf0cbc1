// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "multicam_egomotion/geometry/camera_rig.h"
#include "multicam_egomotion/imu/imu_buffer.h"
#include "multicam_egomotion/imu/imu_calibration.h"
#include "multicam_egomotion/imu/imu_monitor.h"
#include "multicam_egomotion/imu/imu_stamp_gate.h"
#include "multicam_egomotion/odometry/ego_motion.h"
#include "multicam_egomotion/odometry/frame_assembler.h"
#include "multicam_egomotion/tracking/image_monitor.h"

namespace multicam_egomotion {

/// What reaches the odometry: images as frame sets in the order of their stamps, each when the IMU has reached it, and
/// IMU samples in a buffer. Checks both, and tells a clock that has jumped back from single wrong stamps.
class SensorInput {
 public:
  SensorInput(const CameraRig& rig, const ImuCalibration& imu, const EgoMotionOptions& options);

  /// Both answer whether the clock has turned out to have jumped back: what was kept of the other time is forgotten.
  bool addImu(const ImuSample& sample);
  bool addImage(const CameraImage& image, std::int64_t now_ns);

  void advance(std::int64_t now_ns);
  /// No more data will come: nothing is waited for.
  void end();
  /// The next set for which the IMU is there or has been waited for long enough.
  std::optional<FrameSet> next();
  bool waiting() const { return !pending_.empty(); }

  /// Reference stamp of a set on the clock of the IMU.
  std::int64_t inertialStamp(const FrameSet& set) const;
  const ImuBuffer& imu() const { return imu_buffer_; }
  void pruneImu(std::int64_t stamp_ns) { imu_buffer_.prune(stamp_ns); }
  void takeOutFrozen(const ExpectedMotion& motion, FrameSet* set) { image_monitor_.takeOutFrozen(motion, set); }

  /// Forgets the images that wait, and what was there before them.
  void forgetImages();

  /// Adds what was refused here.
  void count(EgoMotionCounters* counters) const;
  std::vector<std::string> faults() const;

 private:
  bool wentBack(const CameraImage& image);
  void forgetOtherTime();
  std::int64_t dataTime(std::int64_t now_ns);
  std::optional<std::string> apart() const;

  const CameraRig rig_;
  bool use_imu_;
  double max_imu_wait_s_;
  FrameAssembler assembler_;
  ImageMonitor image_monitor_;
  ImuBuffer imu_buffer_;
  ImuMonitor imu_monitor_;
  ImuStampGate imu_gate_;
  std::deque<FrameSet> pending_;               ///< complete, waiting for the IMU
  std::vector<std::int64_t> latest_image_ns_;  ///< by camera, in common time
  bool image_went_back_ = false;               ///< the one before, far behind its camera's latest
  std::int64_t now_ns_ = 0;
  std::int64_t newest_ns_ = 0;  ///< newest stamp since the images were forgotten
  bool caller_ahead_ = false;   ///< after a jump back the caller's time may still be the other one
};

}  // namespace multicam_egomotion
