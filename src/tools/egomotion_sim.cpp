// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause

// Writes a bag with images, IMU and exact ground truth of a simulated scenario, its rig and its trajectory. The rig
// file can be wrong on purpose, as after a calibration.

#include <geometry_msgs/TransformStamped.h>
#include <nav_msgs/Odometry.h>
#include <rosbag/bag.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>
#include <sensor_msgs/Imu.h>
#include <tf2_msgs/TFMessage.h>
#include <unistd.h>

#include <boost/program_options.hpp>
#include <cmath>
#include <cstdio>
#include <exception>
#include <iostream>
#include <set>
#include <stdexcept>
#include <string>

#include "multicam_egomotion/odometry/rig_file.h"
#include "simulator/miscalibration.h"
#include "simulator/simulator.h"

namespace {

using namespace multicam_egomotion;

constexpr double kGroundTruthRate = 100.0;  // [Hz]

ros::Time toRos(std::int64_t stamp_ns) {
  ros::Time time;
  time.fromNSec(static_cast<std::uint64_t>(stamp_ns));
  return time;
}

geometry_msgs::Vector3 toMessage(const Eigen::Vector3d& v) {
  geometry_msgs::Vector3 message;
  message.x = v.x();
  message.y = v.y();
  message.z = v.z();
  return message;
}

geometry_msgs::Quaternion toMessage(const Eigen::Quaterniond& q) {
  geometry_msgs::Quaternion message;
  message.x = q.x();
  message.y = q.y();
  message.z = q.z();
  message.w = q.w();
  return message;
}

sensor_msgs::Image imageMessage(const cv::Mat& grey, const std_msgs::Header& header) {
  sensor_msgs::Image message;
  message.header = header;
  message.height = grey.rows;
  message.width = grey.cols;
  message.encoding = "mono8";
  message.step = grey.cols;
  message.data.assign(grey.begin<std::uint8_t>(), grey.end<std::uint8_t>());
  return message;
}

sensor_msgs::CameraInfo cameraInfoMessage(const CameraModel& model, const std_msgs::Header& header) {
  sensor_msgs::CameraInfo message;
  message.header = header;
  message.height = model.height();
  message.width = model.width();
  message.D = model.coefficients();
  switch (model.distortion()) {
    case Distortion::kNone:
      message.distortion_model = "plumb_bob";
      message.D.assign(5, 0.0);
      break;
    case Distortion::kRadtan:
      message.distortion_model = "plumb_bob";
      message.D.resize(5, 0.0);
      break;
    case Distortion::kRationalPolynomial:
      message.distortion_model = "rational_polynomial";
      message.D.resize(8, 0.0);
      break;
    case Distortion::kEquidistant:
      message.distortion_model = "equidistant";
      message.D.resize(4, 0.0);
      break;
  }
  message.K = {model.fx(), 0.0, model.cx(), 0.0, model.fy(), model.cy(), 0.0, 0.0, 1.0};
  message.R = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0};
  message.P = {model.fx(), 0.0, model.cx(), 0.0, 0.0, model.fy(), model.cy(), 0.0, 0.0, 0.0, 1.0, 0.0};
  return message;
}

sensor_msgs::Imu imuMessage(const ImuSample& sample, const ImuCalibration& imu) {
  sensor_msgs::Imu message;
  message.header.stamp = toRos(sample.stamp_ns);
  message.header.frame_id = imu.frame_id;
  message.orientation.w = 1.0;
  message.orientation_covariance[0] = -1.0;  // no orientation (REP-145)
  message.angular_velocity = toMessage(sample.angular_velocity);
  message.linear_acceleration = toMessage(sample.linear_acceleration);
  for (const int i : {0, 4, 8}) {
    message.angular_velocity_covariance[i] = std::pow(imu.gyroscope_noise_density, 2) * imu.rate_hz;
    message.linear_acceleration_covariance[i] = std::pow(imu.accelerometer_noise_density, 2) * imu.rate_hz;
  }
  return message;
}

nav_msgs::Odometry groundTruthMessage(std::int64_t stamp_ns, const BodyState& state) {
  nav_msgs::Odometry message;
  message.header.stamp = toRos(stamp_ns);
  message.header.frame_id = "ground_truth";
  message.child_frame_id = "base_link";
  const Eigen::Vector3d position = state.T_world_body.translation();
  message.pose.pose.position.x = position.x();
  message.pose.pose.position.y = position.y();
  message.pose.pose.position.z = position.z();
  message.pose.pose.orientation = toMessage(Eigen::Quaterniond(state.T_world_body.linear()));
  message.twist.twist.linear = toMessage(state.T_world_body.linear().transpose() * state.velocity);
  message.twist.twist.angular = toMessage(state.angular_velocity);
  return message;
}

tf2_msgs::TFMessage staticTransforms(const Scenario& scenario, std::int64_t stamp_ns) {
  tf2_msgs::TFMessage message;
  const auto add = [&](const std::string& child, const Eigen::Isometry3d& T_body_child) {
    geometry_msgs::TransformStamped transform;
    transform.header.stamp = toRos(stamp_ns);
    transform.header.frame_id = "base_link";
    transform.child_frame_id = child;
    transform.transform.translation = toMessage(Eigen::Vector3d(T_body_child.translation()));
    transform.transform.rotation = toMessage(Eigen::Quaterniond(T_body_child.linear()));
    message.transforms.push_back(transform);
  };
  for (const RigCamera& camera : scenario.rig.cameras()) add(camera.frame_id, camera.T_body_cam);
  add(scenario.imu.frame_id, scenario.imu.T_body_imu);
  return message;
}

// Stamps of the images (IMU clock) and a grid of kGroundTruthRate between them.
std::set<std::int64_t> groundTruthStamps(const Simulator& simulator) {
  std::set<std::int64_t> stamps;
  const auto step = static_cast<std::int64_t>(1e9 / kGroundTruthRate);
  const std::int64_t end = simulator.frameStamp(simulator.frames() - 1);
  for (std::int64_t stamp = Simulator::kFirstStamp; stamp <= end; stamp += step) stamps.insert(stamp);
  for (int frame = 0; frame < simulator.frames(); ++frame) stamps.insert(simulator.frameStamp(frame));
  return stamps;
}

void writeTum(const std::string& path, const Simulator& simulator) {
  FILE* file = std::fopen(path.c_str(), "w");
  if (file == nullptr) throw std::runtime_error("cannot write " + path);
  std::fputs("# stamp x y z qx qy qz qw: base_link in the world (z up), exact\n", file);
  for (const std::int64_t stamp : groundTruthStamps(simulator)) {
    const Eigen::Isometry3d T = simulator.stateAt(stamp).T_world_body;
    const Eigen::Quaterniond q(T.linear());
    std::fprintf(file, "%lld.%09lld %.9f %.9f %.9f %.9f %.9f %.9f %.9f\n", static_cast<long long>(stamp / 1000000000),
                 static_cast<long long>(stamp % 1000000000), T.translation().x(), T.translation().y(),
                 T.translation().z(), q.x(), q.y(), q.z(), q.w());
  }
  if (std::fclose(file) != 0) throw std::runtime_error("cannot write " + path);
}

void writeRig(const std::string& path, const Scenario& scenario, double calibration_error, std::uint64_t seed) {
  const CalibratedRig calibrated = miscalibrated(scenario.rig, scenario.imu, calibration_error, seed);
  RigFile file{calibrated.rig, {}, {}, "base_link", true, calibrated.imu};
  for (const RigCamera& camera : scenario.rig.cameras()) {
    file.image_topics.push_back("/" + camera.name + "/image_raw");
    file.camera_info_topics.push_back("/" + camera.name + "/camera_info");
  }
  writeRigFile(path, file);
}

void writeBag(const std::string& path, const Simulator& simulator, int threads, bool with_images) {
  const Scenario& scenario = simulator.scenario();
  rosbag::Bag bag(path, rosbag::bagmode::Write);
  bag.setCompression(rosbag::compression::LZ4);

  const std::vector<ImuSample> samples = simulator.imuSamples();
  bag.write("/tf_static", toRos(samples.front().stamp_ns), staticTransforms(scenario, samples.front().stamp_ns));
  const bool terminal = isatty(STDERR_FILENO) != 0;
  std::size_t next = 0;
  const auto writeImuUntil = [&](std::int64_t stamp_ns) {
    for (; next < samples.size() && samples[next].stamp_ns <= stamp_ns; ++next) {
      const std::int64_t stamp = samples[next].stamp_ns;
      bag.write("/imu", toRos(stamp), imuMessage(samples[next], scenario.imu));
      bag.write("/ground_truth", toRos(stamp), groundTruthMessage(stamp, simulator.stateAt(stamp)));
    }
  };
  for (int frame = 0; with_images && frame < simulator.frames(); ++frame) {
    const FrameSet set = simulator.renderFrame(frame, threads);
    writeImuUntil(set.stamp_ns);
    for (const CameraImage& image : set.images) {
      const RigCamera& camera = scenario.rig.camera(image.camera);
      std_msgs::Header header;
      header.seq = frame;
      header.stamp = toRos(image.stamp_ns);
      header.frame_id = camera.frame_id;
      bag.write("/" + camera.name + "/camera_info", header.stamp, cameraInfoMessage(camera.model, header));
      bag.write("/" + camera.name + "/image_raw", header.stamp, imageMessage(image.grey, header));
    }
    if (terminal) std::fprintf(stderr, "\r%s: frame %d of %d", path.c_str(), frame + 1, simulator.frames());
  }
  if (terminal && with_images) std::fputc('\n', stderr);
  writeImuUntil(samples.back().stamp_ns);
  bag.close();
}

bool endsIn(const std::string& path, const std::string& extension) {
  return path.size() > extension.size() && path.substr(path.size() - extension.size()) == extension;
}

std::string withoutExtension(const std::string& path) {
  const std::string extension = ".bag";
  if (!endsIn(path, extension)) {
    throw std::runtime_error("output is \"" + path + "\", expected a name that ends in .bag or .rig.yaml");
  }
  return path.substr(0, path.size() - extension.size());
}

std::string scenarioList() {
  std::string list;
  for (const std::string& name : scenarioNames()) list += "  " + name + "\n";
  return list;
}

}  // namespace

int main(int argc, char** argv) {
  namespace po = boost::program_options;
  SimulationOptions options;
  std::string scenario_name, output;
  int threads = 0;
  double calibration_error = 0.0;
  std::uint64_t calibration_seed = 1;
  po::options_description visible("Options");
  visible.add_options()("help,h", "this text")("seed", po::value(&options.seed)->default_value(options.seed),
                                               "of scene, noise and biases")(
      "duration", po::value(&options.duration_s), "first to last image [s] (default: the scenario's own)")(
      "rate", po::value(&options.image_rate_hz), "image rate [Hz] (default: the scenario's own)")(
      "cameras", po::value(&options.cameras), "use the first N cameras of the rig (default: all)")(
      "imu-rate", po::value(&options.imu_rate_hz)->default_value(options.imu_rate_hz), "[Hz]")(
      "image-noise", po::value(&options.image_noise)->default_value(options.image_noise),
      "standard deviation [grey levels]")("imu-noise-scale",
                                          po::value(&options.imu_noise_scale)->default_value(options.imu_noise_scale),
                                          "of noise and biases, 0: exact")(
      "time-offset", po::value(&options.time_offset_s)->default_value(options.time_offset_s),
      "t_imu = t_image + offset [s]")("threads", po::value(&threads)->default_value(0), "0: one a processor core")(
      "no-images", "IMU and ground truth alone")(
      "calibration-error", po::value(&calibration_error)->default_value(calibration_error),
      "of the rig file, as a factor of the sigmas in it; the bag is that of the true rig")(
      "calibration-seed", po::value(&calibration_seed)->default_value(calibration_seed), "of the calibration error");
  po::options_description all;
  all.add(visible).add_options()("scenario", po::value(&scenario_name))("output", po::value(&output));
  po::positional_options_description positions;
  positions.add("scenario", 1).add("output", 1);

  try {
    po::variables_map values;
    po::store(po::command_line_parser(argc, argv).options(all).positional(positions).run(), values);
    po::notify(values);
    if (values.count("help") != 0) {
      std::cout << "egomotion_sim SCENARIO OUT.bag [options]\n"
                << "egomotion_sim SCENARIO OUT.rig.yaml [options]: the rig file alone\n\nScenarios\n"
                << scenarioList() << "\n"
                << visible;
      return 0;
    }
    if (scenario_name.empty() || output.empty()) {
      throw std::runtime_error("expected SCENARIO OUT.bag; scenarios:\n" + scenarioList());
    }
    if (endsIn(output, ".rig.yaml")) {
      writeRig(output, makeScenario(scenario_name, options), calibration_error, calibration_seed);
      return 0;
    }
    const std::string stem = withoutExtension(output);
    const Simulator simulator(makeScenario(scenario_name, options));
    writeRig(stem + ".rig.yaml", simulator.scenario(), calibration_error, calibration_seed);
    writeTum(stem + ".groundtruth.tum", simulator);
    writeBag(output, simulator, threads, values.count("no-images") == 0);
  } catch (const std::exception& error) {
    std::cerr << "egomotion_sim: " << error.what() << "\n";
    return 1;
  }
  return 0;
}
