// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "bag_runner/run_report.h"

#include <sys/resource.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>
#include <iomanip>
#include <sstream>
#include <stdexcept>

#include "multicam_egomotion/ros/calibration_message.h"

namespace multicam_egomotion {
namespace {

double quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0.0;
  const auto nth = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), nth, values.end());
  return *nth;
}

double cpuSeconds() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& time) { return time.tv_sec + 1e-6 * time.tv_usec; };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

double peakMemoryMb() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return usage.ru_maxrss / 1024.0;
}

std::string quoted(const std::string& text) {
  std::ostringstream json;
  json << '"';
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      json << '\\' << c;
    } else if (static_cast<unsigned char>(c) < 0x20) {
      json << "\\u" << std::hex << std::setw(4) << std::setfill('0') << static_cast<int>(c) << std::dec;
    } else {
      json << c;
    }
  }
  json << '"';
  return json.str();
}

std::string parameterJson(XmlRpc::XmlRpcValue value) {
  using XmlRpc::XmlRpcValue;
  std::ostringstream json;
  json << std::setprecision(17);
  switch (value.getType()) {
    case XmlRpcValue::TypeBoolean:
      json << (static_cast<bool>(value) ? "true" : "false");
      break;
    case XmlRpcValue::TypeInt:
      json << static_cast<int>(value);
      break;
    case XmlRpcValue::TypeDouble:
      json << static_cast<double>(value);
      break;
    case XmlRpcValue::TypeString:
      json << quoted(static_cast<std::string>(value));
      break;
    case XmlRpcValue::TypeArray:
      json << '[';
      for (int i = 0; i < value.size(); ++i) json << (i > 0 ? ", " : "") << parameterJson(value[i]);
      json << ']';
      break;
    default:
      json << "null";
  }
  return json.str();
}

/// One JSON object, a member a line.
class JsonObject {
 public:
  JsonObject& add(const std::string& name, const std::string& json) {
    text_ += (text_.empty() ? "" : ", ") + quoted(name) + ": " + json;
    return *this;
  }
  JsonObject& add(const std::string& name, double value) {
    std::ostringstream json;
    json << std::setprecision(10) << value;
    return add(name, json.str());
  }
  template <class Map>
  static std::string counts(const Map& map) {
    JsonObject object;
    for (const auto& [name, count] : map) object.add(name, static_cast<double>(count));
    return object.str();
  }
  std::string str() const { return "{" + text_ + "}"; }

 private:
  std::string text_;
};

std::string listJson(const std::vector<std::string>& values) {
  std::string text;
  for (const std::string& value : values) text += (text.empty() ? "" : ", ") + value;
  return "[" + text + "]";
}

std::string vectorJson(const Eigen::Vector3d& vector) {
  std::ostringstream json;
  json << std::setprecision(10) << '[' << vector.x() << ", " << vector.y() << ", " << vector.z() << ']';
  return json.str();
}

std::string calibrationJson(const CameraCalibration& calibration, const std::string& camera) {
  constexpr double kDegrees = 180.0 / M_PI;
  JsonObject json;
  json.add("camera", quoted(camera));
  json.add("rotation_deg", vectorJson(kDegrees * calibration.rotation));
  json.add("sigma_deg", vectorJson(kDegrees * calibration.covariance.diagonal().cwiseMax(0.0).cwiseSqrt()));
  if (calibration.overlaps) {
    json.add("focal_length_percent", 100.0 * calibration.focal_length);
    json.add("static_error_px", calibration.static_error_px);
  } else {  // not estimated
    json.add("focal_length_percent", "null").add("static_error_px", "null");
  }
  return json.str();
}

}  // namespace

void RunReport::stage(const char* name) {
  const Clock::time_point now = Clock::now();
  const bool whole = std::string(name) == "frame";
  const Clock::time_point begin = whole ? frame_begin_ : stage_begin_;
  times_ms_[name].push_back(std::chrono::duration<double, std::milli>(now - begin).count());
  stage_begin_ = now;
  if (whole) frame_begin_ = now;
}

void RunReport::addResult(const EgoMotionResult& result) {
  ++statuses_[name(result.status)];
  odom_epoch_ = std::max(odom_epoch_, result.odom_epoch);
  const bool has_image = std::any_of(result.image_stamps_ns.begin(), result.image_stamps_ns.end(),
                                     [](std::int64_t stamp_ns) { return stamp_ns != 0; });
  if (!has_image) {
    ++coast_ticks_;
    return;
  }
  ++frames_;
  if (result.keyframe) ++keyframes_;
  if (!result.has_relative_pose) return;
  ++scale_states_[name(result.scale_state)];
  if (!result.solver.empty()) ++solvers_[result.solver];
  tracks_.push_back(result.tracks);
  inliers_.push_back(result.inliers);
}

void RunReport::writeJson(const std::string& path, const EgoMotion& odometry, const Parameters& parameters) const {
  JsonObject times;
  for (const auto& [stage, values] : times_ms_) {
    JsonObject entry;
    entry.add("count", static_cast<double>(values.size()));
    entry.add("median_ms", quantile(values, 0.5)).add("p99_ms", quantile(values, 0.99));
    times.add(stage, entry.str());
  }
  const EgoMotionCounters counters = odometry.counters();
  JsonObject faults;
  faults.add("frame_sets_without_imu", counters.frame_sets_without_imu)
      .add("estimation_failures", counters.estimation_failures)
      .add("time_jumps", counters.time_jumps)
      .add("rejected_imu", counters.rejected_imu)
      .add("late_images", counters.late_images)
      .add("rejected_images", counters.rejected_images)
      .add("undecodable_images", undecodable_images);
  std::vector<std::string> texts, cameras;
  for (const std::string& message : messages) texts.push_back(quoted(message));
  for (const CameraCalibration& one : odometry.calibration()) {
    cameras.push_back(calibrationJson(one, odometry.rig().camera(one.camera).name));
  }
  JsonObject values;
  for (const auto& [name, value] : parameterValues(parameters)) values.add(name, parameterJson(value));

  std::ofstream file(path);
  file << "{\n  \"interrupted\": " << (interrupted ? "true" : "false") << ",\n  \"frames\": " << frames_
       << ",\n  \"poses\": " << poses << ",\n  \"images\": " << images << ",\n  \"imu_samples\": " << imu_samples
       << ",\n  \"coast_ticks\": " << coast_ticks_ << ",\n  \"keyframes\": " << keyframes_
       << ",\n  \"odom_epochs\": " << odom_epoch_ + 1 << ",\n  \"tracks_median\": " << quantile(tracks_, 0.5)
       << ",\n  \"inliers_median\": " << quantile(inliers_, 0.5)
       << ",\n  \"wall_s\": " << std::chrono::duration<double>(Clock::now() - begin_).count()
       << ",\n  \"cpu_s\": " << cpuSeconds() << ",\n  \"peak_memory_mb\": " << peakMemoryMb()
       << ",\n  \"stages\": " << times.str() << ",\n  \"status\": " << JsonObject::counts(statuses_)
       << ",\n  \"scale_state\": " << JsonObject::counts(scale_states_)
       << ",\n  \"solver\": " << JsonObject::counts(solvers_) << ",\n  \"faults\": " << faults.str()
       << ",\n  \"messages\": " << listJson(texts) << ",\n  \"calibration\": " << listJson(cameras)
       << ",\n  \"parameters\": " << values.str() << "\n}\n";
  file.close();
  if (!file) throw std::runtime_error("'" + path + "': not everything could be written: " + std::strerror(errno));
}

std::string RunReport::summary(const EgoMotion& odometry) const {
  std::ostringstream text;
  const double wall_s = std::chrono::duration<double>(Clock::now() - begin_).count();
  text << std::fixed << std::setprecision(1) << frames_ << " frames, " << poses << " poses, " << wall_s << " s ("
       << cpuSeconds() << " s of CPU, " << peakMemoryMb() << " MB); tracks " << std::setprecision(0)
       << quantile(tracks_, 0.5) << ", inliers " << quantile(inliers_, 0.5) << " (medians)\n"
       << std::setprecision(2);
  for (const auto& [stage, values] : times_ms_) {
    text << "  " << std::left << std::setw(10) << stage << " median " << quantile(values, 0.5) << " ms, p99 "
         << quantile(values, 0.99) << " ms\n";
  }
  for (const CameraCalibration& one : odometry.calibration()) {
    text << "  " << odometry.rig().camera(one.camera).name << " turned by " << rotationText(one);
    if (one.overlaps) {
      text << ", focal length " << std::showpos << 100.0 * one.focal_length << std::noshowpos << " %, static error "
           << one.static_error_px << " px";
    }
    text << "\n";
  }
  for (const std::string& message : messages) text << "  at the end: " << message << "\n";
  return text.str();
}

}  // namespace multicam_egomotion
