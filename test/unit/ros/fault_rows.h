// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "fault_row.h"

namespace multicam_egomotion {

/// After which a fault of the IMU is named [s]: 3 s for whoever reads /diagnostics, which come once a second.
constexpr double kNamed = 2.0;

inline std::vector<FaultRow> simulatedRows() {
  return {
      FaultRow("none", {}),

      // Time
      FaultRow("time_jump_back", {"time_jump:at=2.5,by=-10"})
          .during(2.5, 2.5)
          .stampsOffBy(-10.0)
          .counts("time jumps", 1)
          .counts("odom epoch", 1)
          .epochs(2)
          .poses(0.95)
          .drifts(1.5, 0.02, 0.5),
      FaultRow("time_jump_forward", {"time_jump:at=2.5,by=0.4"}).during(2.5, 2.5).stampsOffBy(0.4).says("COASTING"),
      FaultRow("time_jump_forward_far", {"time_jump:at=2.5,by=10"})
          .during(2.5, 2.5)
          .stampsOffBy(10.0)
          .counts("time jumps", 1),
      FaultRow("time_jump_back_short", {"time_jump:at=2.5,by=-0.3"})
          .during(2.5, 2.5)
          .stampsOffBy(-0.3)
          .counts("time jumps", 1)
          .counts("odom epoch", 1)
          .epochs(2)
          .poses(0.95)
          .drifts(1.5, 0.02, 0.5),
      FaultRow("time_jump_back_continued", {"time_jump:at=2.5,by=-10"})
          .with("on_time_jump", "continue")
          .during(2.5, 2.5)
          .stampsOffBy(-10.0)
          .stampsJump()
          .counts("time jumps", 1)
          .poses(0.95)
          .drifts(1.5, 0.02, 0.5),
      // What the restart of the window does not know of the lengths yet is in the drift.
      FaultRow("time_gap", {"time_gap:from=2.5,to=3"})
          .during(2.5, 3.0)
          .says("COASTING")
          .poses(0.9)
          .drifts(1.5, 0.05, 0.3),
      FaultRow("long_time_gap", {"time_gap:from=2.5,to=4"})
          .during(2.5, 4.0)
          .says("COASTING")
          .counts("estimation failures", 0)
          .poses(0.9)
          .drifts(1.5, 0.02, 0.5),
      FaultRow("bag_loop", {"bag_loop:times=2"})
          .counts("time jumps", 1)
          .counts("odom epoch", 1)
          .epochs(2)
          .drifts(1.5, 0.01, 0.3),
      FaultRow("duplicate_images", {"duplicate_images:every=2"}).counts("rejected images", 50),
      FaultRow("duplicate_imu", {"duplicate_imu:every=3"}).counts("rejected IMU samples", 300),
      FaultRow("out_of_order_images", {"out_of_order_images:camera=0,every=5,delay=0.08"}).counts("late images", 10),
      FaultRow("out_of_order_imu", {"out_of_order_imu"}).counts("rejected IMU samples", 100),
      FaultRow("imu_late_within_the_wait", {"imu_late:delay=0.1"}),
      FaultRow("imu_late_beyond_the_wait", {"imu_late:delay=0.5"})
          .counts("frame sets without IMU", 50)
          .says("IMU: newest sample")
          .drifts(1.5, 0.02, 0.5),
      FaultRow("clocks_far_apart", {"clock_offset:offset=100"})
          .during(0.0, 200.0)
          .counts("frame sets without IMU", 1)
          .counts("late images", 0)
          .says("behind the images: silent, late, or clocks apart?")
          .poses(0.0),
      FaultRow("zero_stamps", {"zero_stamps"}).counts("rejected images", 10).counts("rejected IMU samples", 100),

      // Cameras
      FaultRow("camera_lost", {"camera_lost:camera=1,from=2.5,to=3.5"})
          .during(2.5, 3.5)
          .says("no images of cam1")
          .counts("late images", 0),
      FaultRow("first_camera_lost", {"camera_lost:camera=0,from=2.5,to=3.5"})
          .during(2.5, 3.5)
          .says("no images of cam0")
          .counts("late images", 0),
      FaultRow("all_cameras_lost", {"camera_lost:camera=-1,from=2.5,to=3.5"}).during(2.5, 3.5).says("COASTING"),
      FaultRow("image_encoding_unknown_of_all", {"image_encoding:encoding=unknown,from=2.5,to=3.5"})
          .during(2.5, 3.5)
          .counts("undecodable images", 30)
          .says("COASTING"),
      FaultRow("image_frozen", {"image_frozen:from=2.5,to=3.5"})
          .during(2.5, 3.5)
          .says("frozen")
          .counts("estimation failures", 0),
      FaultRow("image_frozen_of_one_camera", {"image_frozen:camera=1,from=2.5,to=3.5"}).during(2.5, 3.5).says("frozen"),
      FaultRow("camera_late_within_the_timeout", {"camera_late:delay=0.04,from=2.5,to=3.5"}).during(2.5, 3.5),
      FaultRow("camera_late", {"camera_late:delay=0.2,from=2.5,to=3.5"}).during(2.5, 3.5).counts("late images", 10),
      FaultRow("image_size", {"image_size:from=2.5,to=3.5"}).during(2.5, 3.5).counts("rejected images", 15),
      FaultRow("image_encoding_known", {"image_encoding:encoding=bgr8,from=2.5,to=3.5"}).during(2.5, 3.5),
      FaultRow("image_encoding_16_bits", {"image_encoding:encoding=mono16,from=2.5,to=3.5"}).during(2.5, 3.5),
      FaultRow("image_encoding_unknown", {"image_encoding:camera=1,encoding=unknown,from=2.5,to=3.5"})
          .during(2.5, 3.5)
          .counts("undecodable images", 15),
      FaultRow("image_truncated", {"image_truncated:from=2.5,to=3.5"})
          .during(2.5, 3.5)
          .counts("undecodable images", 15),
      FaultRow("image_blank", {"image_blank:from=2.5,to=3.5"})
          .during(2.5, 3.5)
          .counts("estimation failures", 14)
          .says("COASTING"),
      FaultRow("image_dark", {"image_dark:from=2.5,to=3.5"})
          .during(2.5, 3.5)
          .counts("estimation failures", 14)
          .says("COASTING"),
      FaultRow("image_saturated", {"image_saturated:from=2.5,to=3.5"})
          .during(2.5, 3.5)
          .counts("estimation failures", 14)
          .says("COASTING"),
      FaultRow("image_noise", {"image_noise:from=2.5,to=3.5"}).during(2.5, 3.5).drifts(1.5, 0.02, 0.3),
      // Of 100 such noises 90 leave a drift of less than 0.025 m in the time after. A rig of 320x240 that is not
      // calibrated yet learns some of the noise as calibration: its covariance is then too small.
      FaultRow("image_noise_heavy", {"image_noise:sigma=100,from=2.5,to=3.5"})
          .during(2.5, 3.5)
          .drifts(1.5, 0.05, 0.3)
          .beyondThreeSigma(0.9),
      FaultRow("obstruction_of_one_camera", {"obstruction:camera=0,from=2.5,to=3.5"}).during(2.5, 3.5),
      FaultRow("obstruction_of_all", {"obstruction:camera=-1,width=1,from=2.5,to=3.5"})
          .during(2.5, 3.5)
          .counts("estimation failures", 14)
          .says("COASTING"),
      FaultRow("moving_object", {"moving_object:from=2.5,to=3.5"}).during(2.5, 3.5),
      FaultRow("large_moving_object", {"moving_object:size=0.7,from=2.5,to=3.5"}).during(2.5, 3.5),
      FaultRow("exposure_steps", {"exposure_steps:from=2.5,to=3.5"}).during(2.5, 3.5).counts("estimation failures", 0),
      FaultRow("camera_info_absent", {"camera_info_absent"}).refused("no CameraInfo in the bag on 'cam1/camera_info'"),
      FaultRow("camera_info_zero", {"camera_info_zero"})
          .refused("CameraInfo of 'cam1': found K[0] = 0, expected a calibrated camera"),
      FaultRow("camera_info_mismatch", {"camera_info_mismatch"})
          .counts("rejected images", 76)
          .says("cam1: image is 320x240, expected 160x120")
          .onlyNamed(),  // one camera, whose scale comes from the IMU
      FaultRow("camera_info_mismatch_of_all", {"camera_info_mismatch:camera=-1"})
          .counts("rejected images", 152)
          .says("320x240, expected 160x120")
          .poses(0.0),
      FaultRow("shared_frame_id", {"shared_frame_id"}).refused("shared with another camera and P[3] = 0"),

      // IMU
      FaultRow("imu_gap", {"imu_gap:from=2.5,to=2.8"}).during(2.5, 2.8).counts("frame sets without IMU", 1),
      FaultRow("imu_gap_of_a_second", {"imu_gap:from=2.5,to=3.5"})
          .during(2.5, 3.5)
          .counts("frame sets without IMU", 10),
      FaultRow("imu_stops", {"imu_silent:from=2.5"})
          .during(2.5, 2.5)
          .counts("frame sets without IMU", 40)
          .says("IMU: newest sample")
          .drifts(1.5, 0.02, 1.0),
      FaultRow("imu_never_there", {"imu_silent:from=0"}).refused("no IMU data (without an IMU: use_imu: false)"),
      FaultRow("imu_nan", {"imu_nan:from=2.5,to=3.5"}).during(2.5, 3.5).counts("rejected IMU samples", 40),
      FaultRow("imu_nan_only", {"imu_nan:every=1,from=2.5,to=3.5"})
          .during(2.5, 3.5)
          .counts("rejected IMU samples", 200)
          .counts("frame sets without IMU", 10),
      FaultRow("imu_bias", {"imu_bias"}).counts("gyroscope bias [rad/s]", 0.05).drifts(1.5, 0.03, 2.0),
      FaultRow("imu_frozen", {"imu_frozen:from=2,to=4.5"}).during(2.0, 4.5).says("frozen?").onlyNamed(),
      FaultRow("imu_saturated", {"imu_saturated:from=2,to=4.5"}).during(2.0, 4.5).says("saturated?").onlyNamed(),
      FaultRow("imu_nan_named", {"imu_nan:from=2,to=4.5"})
          .during(2.0, 4.5)
          .counts("rejected IMU samples", 100)
          .says("not finite", kNamed)
          .onlyNamed(),
      FaultRow("imu_g_units", {"imu_g_units"}).during(0.0, 3.0).says("in g?", kNamed).onlyNamed(),
      FaultRow("imu_rate", {"imu_rate:rate=10"}).during(0.0, 3.0).says("expected 200 Hz").drifts(2.0, 0.02, 0.3),
      FaultRow("imu_swapped_axes", {"imu_swapped_axes"})
          .during(0.0, 5.0)
          .says("x is y, y is x", kNamed)
          .onceTurned()
          .onlyNamed(),
      FaultRow("gyroscope_swapped_axes", {"imu_swapped_axes:axes=yz,sensor=gyroscope"})
          .during(0.0, 5.0)
          .says("y is z, z is y", kNamed)
          .onceTurned()
          .onlyNamed(),
      FaultRow("clock_offset", {"clock_offset:offset=0.02"})
          .stampsOffBy(0.02)
          .during(0.0, 5.0)
          .says("clocks -20 ms apart", kNamed)
          .onceTurned()
          .onlyNamed(),
      FaultRow("accelerometer_swapped_axes", {"imu_swapped_axes:sensor=accelerometer"})
          .during(0.0, 5.0)
          .says("accelerometer disagrees with the images", kNamed)
          .onceTurned()
          .onlyNamed(),
      FaultRow("imu_orientation_unused", {"imu_orientation"}),
      FaultRow("imu_orientation_without_covariance", {"imu_orientation"}).with("imu_orientation", "message"),
  };
}

inline std::vector<FaultRow> recordedRows() {
  return {
      FaultRow("all_cameras_lost", {"camera_lost:camera=-1,from=2.5,to=3.5"})
          .during(2.5, 3.5)
          .says("COASTING")
          .gainsAtMost(0.15),
      FaultRow("time_gap", {"time_gap:from=3,to=3.5"}).during(3.0, 3.5).says("COASTING"),
      FaultRow("bag_loop", {"bag_loop:times=2"}).counts("time jumps", 1).counts("odom epoch", 1).epochs(2),
      FaultRow("image_blank", {"image_blank:from=3,to=4"})
          .during(3.0, 4.0)
          .counts("estimation failures", 19)
          .says("COASTING"),
      FaultRow("camera_late", {"camera_late:delay=0.2,from=2.5,to=4"}).during(2.5, 4.0).counts("late images", 25),
      FaultRow("imu_nan", {"imu_nan:from=3,to=4"}).during(3.0, 4.0).counts("rejected IMU samples", 39),
      FaultRow("imu_gap", {"imu_gap:from=3,to=3.5"}).during(3.0, 3.5).counts("frame sets without IMU", 5),
  };
}

}  // namespace multicam_egomotion
