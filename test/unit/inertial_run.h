// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "multicam_egomotion/geometry/so3.h"
#include "multicam_egomotion/imu/imu_buffer.h"
#include "multicam_egomotion/odometry/motion_model.h"
#include "simulator/simulator.h"

namespace multicam_egomotion {

inline Eigen::Isometry3d motion(const Eigen::Vector3d& p, const Eigen::Vector3d& rotation_vector) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = expSO3(rotation_vector);
  T.translation() = p;
  return T;
}

inline RelativeMotion seen(const Eigen::Isometry3d& T, double position_sigma, double rotation_sigma) {
  RelativeMotion vision;
  vision.T_a_b = T;
  vision.covariance.setZero();
  vision.covariance.diagonal().head<3>().setConstant(position_sigma * position_sigma);
  vision.covariance.diagonal().tail<3>().setConstant(rotation_sigma * rotation_sigma);
  return vision;
}

// The inertial model over a simulated run, with what vision would say.
class InertialRun {
 public:
  InertialRun(const std::string& name, double seconds, double imu_noise_scale, const InertialStateOptions& options = {})
      : simulator_(scenario(name, seconds, imu_noise_scale)) {
    imu_ = simulator_.imu();
    for (const SimulatedImu& one : imu_) buffer_.add(one.sample);
    model_ = std::make_unique<InertialMotion>(simulator_.scenario().imu, options, &buffer_, false, 0.0, firstCamera());
  }

  Eigen::Isometry3d truth(int frame) const { return simulator_.stateAtFrame(frame).T_world_body; }
  Eigen::Isometry3d step(int frame) const { return truth(frame - 1).inverse() * truth(frame); }
  double tiltError(int frame) const {
    return std::acos(std::min(1.0, model_->up().dot(truth(frame).linear().transpose() * Eigen::Vector3d::UnitZ())));
  }

  /// Centre of the camera in the body [m].
  Eigen::Vector3d firstCamera() const { return simulator_.scenario().rig.camera(0).T_body_cam.translation(); }

  void run(int first, int last, bool vision, bool scale) {
    for (int frame = first; frame <= last; ++frame) {
      model_->advanceTo(simulator_.frameStamp(frame));
      if (vision) model_->correct(seen(step(frame), 5e-4, 3e-4), scale);
      if (frame < last) model_->markFrame();
    }
  }

  Simulator simulator_;
  std::vector<SimulatedImu> imu_;
  ImuBuffer buffer_;
  std::unique_ptr<InertialMotion> model_;

 private:
  static Scenario scenario(const std::string& name, double seconds, double imu_noise_scale) {
    SimulationOptions options;
    options.duration_s = seconds;
    options.imu_noise_scale = imu_noise_scale;
    options.cameras = 1;
    return makeScenario(name, options);
  }
};

}  // namespace multicam_egomotion
