// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <rosbag/bag.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>
#include <sensor_msgs/Imu.h>
#include <tf2_eigen/tf2_eigen.h>
#include <tf2_msgs/TFMessage.h>

#include <string>
#include <vector>

#include "../scaled_rig.h"
#include "multicam_egomotion/ros/messages.h"
#include "simulator/simulator.h"

namespace multicam_egomotion {

/// Writes a simulation of a stereo rig (radtan) as a driver would record it: images, CameraInfo, IMU and TF.
class SimulatedBag {
 public:
  SimulatedBag(const std::string& path, const Simulator& simulator)
      : simulator_(simulator), samples_(simulator.imuSamples()), bag_(path, rosbag::bagmode::Write) {
    writeTransforms();
    for (int frame = 0; frame < simulator_.frames(); ++frame) {
      const FrameSet set = simulator_.renderFrame(frame, 1);
      writeImuUntil(set.stamp_ns);
      for (const CameraImage& image : set.images) writeImage(image);
    }
    writeImuUntil(samples_.back().stamp_ns);
    bag_.close();
  }

 private:
  void writeTransforms() {
    tf2_msgs::TFMessage transforms;
    const auto add = [&](const std::string& frame, const Eigen::Isometry3d& T_body_frame) {
      geometry_msgs::TransformStamped transform = tf2::eigenToTransform(T_body_frame);
      transform.header.stamp = toRosTime(samples_.front().stamp_ns);
      transform.header.frame_id = "base_link";
      transform.child_frame_id = frame;
      transforms.transforms.push_back(transform);
    };
    const Scenario& scenario = simulator_.scenario();
    for (const RigCamera& camera : scenario.rig.cameras()) add(camera.frame_id, camera.T_body_cam);
    add(scenario.imu.frame_id, scenario.imu.T_body_imu);
    bag_.write("/tf_static", toRosTime(samples_.front().stamp_ns), transforms);
  }

  void writeImuUntil(std::int64_t stamp_ns) {
    for (; next_ < samples_.size() && samples_[next_].stamp_ns <= stamp_ns; ++next_) {
      sensor_msgs::Imu message;
      message.header.stamp = toRosTime(samples_[next_].stamp_ns);
      message.header.frame_id = simulator_.scenario().imu.frame_id;
      message.orientation_covariance[0] = -1.0;
      message.angular_velocity = toRosVector(samples_[next_].angular_velocity);
      message.linear_acceleration = toRosVector(samples_[next_].linear_acceleration);
      bag_.write("/imu", message.header.stamp, message);
    }
  }

  void writeImage(const CameraImage& image) {
    const RigCamera& camera = simulator_.scenario().rig.camera(image.camera);
    const CameraModel& model = camera.model;
    sensor_msgs::Image message;
    message.header.stamp = toRosTime(image.stamp_ns);
    message.header.frame_id = camera.frame_id;
    message.encoding = "mono8";
    message.height = image.grey.rows;
    message.width = message.step = image.grey.cols;
    message.data.assign(image.grey.begin<std::uint8_t>(), image.grey.end<std::uint8_t>());
    sensor_msgs::CameraInfo info;
    info.header = message.header;
    info.height = message.height;
    info.width = message.width;
    info.distortion_model = "plumb_bob";
    info.D = model.coefficients();
    info.D.resize(5, 0.0);
    info.K = {model.fx(), 0.0, model.cx(), 0.0, model.fy(), model.cy(), 0.0, 0.0, 1.0};
    info.R = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0};
    info.P = {model.fx(), 0.0, model.cx(), 0.0, 0.0, model.fy(), model.cy(), 0.0, 0.0, 0.0, 1.0, 0.0};
    bag_.write("/" + camera.name + "/camera_info", message.header.stamp, info);
    bag_.write("/" + camera.name + "/image_raw", message.header.stamp, message);
  }

  const Simulator& simulator_;
  std::vector<ImuSample> samples_;
  std::size_t next_ = 0;
  rosbag::Bag bag_;
};

}  // namespace multicam_egomotion
