// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "multicam_egomotion/ros/parameters.h"

namespace multicam_egomotion {

/// Names every parameter once, with its range or choices. `v` is called with (name, value, lowest, highest) for
/// numbers, (name, value, {choices}) or (name, value) for texts, (name, value) for flags and lists.
template <class Visitor>
void visitParameters(Parameters& p, Visitor& v) {
  NodeOptions& n = p.node;
  v("rig_file", n.rig_file);
  v("rig_imu_file", n.rig_imu_file);
  v("cameras", n.cameras, 1, CameraRig::kMaxCameras);
  v("images_rectified", n.images_rectified);
  v("camera_time_offset_s", n.camera_time_offset_s, -10, 10);
  v("image_transport", n.image_transport);
  v("mask_files", n.mask_files);
  v("odom_frame", n.odom_frame);
  v("base_frame", n.base_frame);
  v("publish_tf", n.publish_tf);
  v("publish_previous_tf", n.publish_previous_tf);
  v("publish_features", n.publish_features);
  v("publish_points", n.publish_points);
  v("path_period_s", n.path_period_s, 0, 3600);
  v("path_length", n.path_length, 2, 1000000);
  v("start_paused", n.start_paused);
  v("forget_biases", n.forget_biases);

  ImuCalibration& i = p.imu;
  v("imu/rate_hz", i.rate_hz, 1, 10000);
  v("imu/gyroscope_noise_density", i.gyroscope_noise_density, 1e-9, 1);
  v("imu/gyroscope_random_walk", i.gyroscope_random_walk, 1e-12, 1);
  v("imu/accelerometer_noise_density", i.accelerometer_noise_density, 1e-9, 10);
  v("imu/accelerometer_random_walk", i.accelerometer_random_walk, 1e-12, 10);

  EgoMotionOptions& o = p.odometry;
  v("use_imu", o.use_imu);
  v("calibrate_online", o.calibrate_online);
  v("imu_orientation", o.imu_orientation, {"filter", "message"});
  v("solver", o.solver, {"auto", "4pt-vertical", "4pt-axis"});
  v("seed", o.seed, 0, 2147483647);
  v("max_imu_wait_s", o.max_imu_wait_s, 0, 10);
  v("max_coast_s", o.max_coast_s, 0, 3600);
  v("max_tilt_correction_rate", o.max_tilt_correction_rate, 0, 10);
  v("constant_rate_sigma", o.constant_rate_sigma, 1e-6, 3.15);
  v("initial_velocity_sigma", o.initial_velocity_sigma, 1e-6, 1000);
  v("on_time_jump", o.on_time_jump, {"reset", "continue"});

  FrameAssemblerOptions& a = o.assembler;
  v("assembler/sync_slop_s", a.sync_slop_s, 0, 1);
  v("assembler/sync_timeout_s", a.sync_timeout_s, 0, 10);
  v("assembler/min_cameras", a.min_cameras, 1, CameraRig::kMaxCameras);
  v("assembler/max_stamp_jump_s", a.max_stamp_jump_s, 1e-3, 3600);

  FeatureTrackerOptions& t = o.tracker;
  v("tracker/features_per_camera", t.features_per_camera, 4, 10000);
  v("tracker/min_distance_px", t.min_distance_px, 1, 1000);
  v("tracker/fast_threshold", t.fast_threshold, 1, 254);
  v("tracker/patch_size_px", t.patch_size_px, 7, 21);
  v("tracker/pyramid_levels", t.pyramid_levels, 1, 6);
  v("tracker/max_forward_backward_error_px", t.max_forward_backward_error_px, 0.01, 100);
  v("tracker/max_reference_correction_px", t.max_reference_correction_px, 0, 100);
  v("tracker/max_epipolar_error_px", t.max_epipolar_error_px, 0.01, 100);
  v("tracker/min_distance_m", t.min_distance_m, 1e-3, 1000);

  InertialStateOptions& s = o.inertial;
  v("inertial/gravity", s.gravity, 1, 30);
  v("inertial/initial_velocity_sigma", s.initial_velocity_sigma, 1e-6, 1000);
  v("inertial/gyroscope_bias_sigma", s.gyroscope_bias_sigma, 1e-9, 10);
  v("inertial/accelerometer_bias_sigma", s.accelerometer_bias_sigma, 1e-9, 100);
  v("inertial/gyroscope_noise_floor", s.gyroscope_noise_floor, 0, 1);
  v("inertial/accelerometer_noise_floor", s.accelerometer_noise_floor, 0, 10);
  v("inertial/gyroscope_scale_sigma", s.gyroscope_scale_sigma, 0, 1);
  v("inertial/accelerometer_scale_sigma", s.accelerometer_scale_sigma, 0, 1);
  v("inertial/scale_error_time_s", s.scale_error_time_s, 1e-3, 1000);
  v("inertial/motion_acceleration_sigma", s.motion_acceleration_sigma, 1e-6, 1000);
  v("inertial/still_acceleration_sigma", s.still_acceleration_sigma, 1e-6, 1000);
  v("inertial/still_rate_spread", s.still_rate_spread, 1e-6, 100);
  v("inertial/still_acceleration_spread", s.still_acceleration_spread, 1e-6, 100);
  v("inertial/still_rate_sigma", s.still_rate_sigma, 1e-6, 100);
  v("inertial/gravity_window_s", s.gravity_window_s, 1e-3, 100);
  v("inertial/max_sample_gap_s", s.max_sample_gap_s, 1e-4, 10);
  v("inertial/gap_rate_sigma", s.gap_rate_sigma, 1e-6, 100);
  v("inertial/gap_acceleration_sigma", s.gap_acceleration_sigma, 1e-6, 1000);
  v("inertial/rejections_before_recovery", s.rejections_before_recovery, 1, 1000);

  RobustEstimatorOptions& r = o.ransac;
  v("ransac/max_epipolar_error_px", r.max_epipolar_error_px, 0.01, 100);
  v("ransac/success_probability", r.success_probability, 0.5, 0.9999999);
  v("ransac/max_samples", r.max_samples, 1, 1000000);
  v("ransac/min_samples", r.min_samples, 1, 1000000);
  v("ransac/min_inliers", r.min_inliers, 4, 10000);
  v("ransac/max_rotation_sigmas", r.max_rotation_sigmas, 0.1, 1000);
  v("ransac/refinement/max_iterations", r.refinement.max_iterations, 1, 1000);
  v("ransac/refinement/pixel_sigma", r.refinement.pixel_sigma, 0.001, 100);
  v("ransac/refinement/robust_width_px", r.refinement.robust_width_px, 0.01, 100);

  WindowOptions& w = o.window;
  v("window/max_keyframes", w.max_keyframes, 1, 100);
  v("window/keyframe_parallax_px", w.keyframe_parallax_px, 0, 1000);
  v("window/keyframe_min_shared", w.keyframe_min_shared, 0, 1);
  v("window/initial_pixel_sigma", w.initial_pixel_sigma, 0.001, 100);
  v("window/min_pixel_sigma", w.min_pixel_sigma, 0.001, 100);
  v("window/max_pixel_sigma", w.max_pixel_sigma, 0.001, 100);
  v("window/outlier_sigmas", w.outlier_sigmas, 1, 100);
  v("window/min_distance", w.min_distance, 0, 1000);
  v("window/bundle/max_iterations", w.bundle.max_iterations, 1, 1000);
  v("window/bundle/relative_decrease", w.bundle.relative_decrease, 0, 1);
  v("window/bundle/inverse_distance_sigma", w.bundle.inverse_distance_sigma, 0.01, 1000);
  v("window/bundle/robust_width", w.bundle.robust_width, 0.01, 1000);
}

}  // namespace multicam_egomotion
