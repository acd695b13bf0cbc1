// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "simulator/simulator.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <thread>

#include "simulator/random.h"

namespace multicam_egomotion {

namespace {

constexpr std::uint64_t kImuStream = 1, kFirstImageStream = 1000;

int threadCount(int wanted) {
  return wanted > 0 ? wanted : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

}  // namespace

Simulator::Simulator(const Scenario& scenario)
    : scenario_(scenario),
      frames_(static_cast<int>(std::floor(scenario.options.duration_s * scenario.options.image_rate_hz + 1e-6)) + 1) {
  for (const RigCamera& camera : scenario_.rig.cameras()) renderers_.emplace_back(camera.model);
}

std::int64_t Simulator::frameStamp(int frame) const {
  return kFirstStamp + std::llround(frame * 1e9 / scenario_.options.image_rate_hz);
}

BodyState Simulator::stateAt(std::int64_t stamp_ns) const {
  return scenario_.trajectory.at(1e-9 * static_cast<double>(stamp_ns - kFirstStamp));
}

BodyState Simulator::stateAtFrame(int frame) const {
  return stateAt(frameStamp(frame) + std::llround(1e9 * scenario_.options.time_offset_s));
}

std::vector<SimulatedImu> Simulator::imu() const {
  const ImuCalibration& imu = scenario_.imu;
  const SimulationOptions& options = scenario_.options;
  const Eigen::Matrix3d R_imu_body = imu.T_body_imu.linear().transpose();
  const Eigen::Vector3d gravity(0.0, 0.0, -kGravity);
  const double scale = options.imu_noise_scale;
  const double density_to_sample = scale * std::sqrt(options.imu_rate_hz);
  const double walk_to_step = scale / std::sqrt(options.imu_rate_hz);

  Random random(options.seed, kImuStream);
  Eigen::Vector3d gyroscope_bias = scale * options.gyroscope_bias * random.gaussian3();
  Eigen::Vector3d accelerometer_bias = scale * options.accelerometer_bias * random.gaussian3();
  // Past the last image by more than any time offset.
  const int count = static_cast<int>(std::ceil((kImuLead + options.duration_s + 0.3) * options.imu_rate_hz)) + 1;
  const std::int64_t first = kFirstStamp - std::llround(1e9 * kImuLead);
  std::vector<SimulatedImu> result;
  result.reserve(count);
  for (int i = 0; i < count; ++i) {
    SimulatedImu simulated{{}, gyroscope_bias, accelerometer_bias};
    ImuSample& sample = simulated.sample;
    sample.stamp_ns = first + std::llround(i * 1e9 / options.imu_rate_hz);
    const BodyState state = stateAt(sample.stamp_ns);
    const Eigen::Vector3d force =
        state.T_world_body.linear().transpose() * (state.accelerationOf(imu.T_body_imu.translation()) - gravity);
    sample.angular_velocity = R_imu_body * state.angular_velocity + gyroscope_bias +
                              imu.gyroscope_noise_density * density_to_sample * random.gaussian3();
    sample.linear_acceleration = R_imu_body * force + accelerometer_bias +
                                 imu.accelerometer_noise_density * density_to_sample * random.gaussian3();
    result.push_back(simulated);
    gyroscope_bias += imu.gyroscope_random_walk * walk_to_step * random.gaussian3();
    accelerometer_bias += imu.accelerometer_random_walk * walk_to_step * random.gaussian3();
  }
  return result;
}

std::vector<ImuSample> Simulator::imuSamples() const {
  std::vector<ImuSample> samples;
  for (const SimulatedImu& one : imu()) samples.push_back(one.sample);
  return samples;
}

FrameSet Simulator::renderFrame(int frame, int threads) const {
  const Eigen::Isometry3d T_world_body = stateAtFrame(frame).T_world_body;
  FrameSet set;
  set.stamp_ns = frameStamp(frame);
  const int cameras = scenario_.rig.size();
  for (int camera = 0; camera < cameras; ++camera) {
    const std::uint64_t stream = kFirstImageStream + static_cast<std::uint64_t>(frame) * cameras + camera;
    const cv::Mat image = renderImage(camera, T_world_body, threads);
    set.images.push_back(
        {camera, set.stamp_ns, addImageNoise(image, scenario_.options.image_noise, scenario_.options.seed, stream)});
  }
  return set;
}

cv::Mat Simulator::renderImage(int camera, const Eigen::Isometry3d& T_world_body, int threads) const {
  const Eigen::Isometry3d T_world_cam = T_world_body * scenario_.rig.camera(camera).T_body_cam;
  return renderers_[camera].render(*scenario_.scene, T_world_cam, threadCount(threads));
}

double Simulator::distance(int camera, const Eigen::Isometry3d& T_world_body, const Eigen::Vector2d& pixel) const {
  const RigCamera& one = scenario_.rig.camera(camera);
  Eigen::Vector3d bearing;
  if (!one.model.unproject(pixel, &bearing)) return std::numeric_limits<double>::quiet_NaN();
  const Eigen::Isometry3d T_world_cam = T_world_body * one.T_body_cam;
  return scenario_.scene->castRay(T_world_cam.translation(), T_world_cam.linear() * bearing).distance;
}

}  // namespace multicam_egomotion
