// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "fault_injection/fault_registry.h"

#include <algorithm>
#include <limits>
#include <sstream>
#include <stdexcept>

#include "fault_injection/camera_faults.h"
#include "fault_injection/imu_faults.h"
#include "fault_injection/picture_faults.h"
#include "fault_injection/time_faults.h"

namespace multicam_egomotion {
namespace {

constexpr double kEver = std::numeric_limits<double>::infinity();

FaultParameter number(const std::string& name, const std::string& value, const std::string& unit, double least,
                      double most) {
  return {name, value, unit, least, most, false, {}};
}

FaultParameter count(const std::string& name, const std::string& value, const std::string& unit, double least,
                     double most) {
  return {name, value, unit, least, most, true, {}};
}

FaultParameter choice(const std::string& name, const std::string& value, const std::vector<std::string>& choices) {
  return {name, value, "", 0.0, 0.0, false, choices};
}

FaultParameter from(const std::string& value) { return number("from", value, "s", 0.0, 1e9); }
FaultParameter to(const std::string& value) { return number("to", value, "s", 0.0, kEver); }
FaultParameter delay(const std::string& value) { return number("delay", value, "s", 0.0, 1e6); }
FaultParameter every(const std::string& value) { return count("every", value, "messages", 1, 1e9); }
FaultParameter camera(const std::string& value) { return count("camera", value, "index, -1: all", -1, 7); }
FaultParameter sensor() { return choice("sensor", "both", {"both", "gyroscope", "accelerometer"}); }

}  // namespace

const std::vector<FaultKind>& faultKinds() {
  static const std::vector<FaultKind> kinds = {
      // Time
      {"time_jump",
       "all stamps from a moment on are off: a clock that is set",
       {number("at", "3", "s", 0.0, 1e9), number("by", "-10", "s", -1e9, 1e9)},
       timeJump},
      {"time_gap", "no images and no IMU for a while", {from("3"), to("3.5")}, timeGap},
      {"bag_loop",
       "the whole recording again, with its original stamps",
       {count("times", "2", "passes", 1, 1000), number("pause", "0.5", "s", 0.0, 1e6)},
       bagLoop},
      {"duplicate_images",
       "every n-th image arrives twice",
       {camera("-1"), every("3"), delay("0.005"), from("0"), to("inf")},
       duplicateImages},
      {"duplicate_imu",
       "every n-th IMU sample arrives twice",
       {every("3"), delay("0.001"), from("0"), to("inf")},
       duplicateImu},
      {"out_of_order_images",
       "every n-th image arrives after its successor",
       {camera("-1"), every("5"), delay("0.12"), from("0"), to("inf")},
       outOfOrderImages},
      {"out_of_order_imu",
       "every n-th IMU sample arrives after its successors",
       {every("10"), delay("0.012"), from("0"), to("inf")},
       outOfOrderImu},
      {"imu_late", "the IMU arrives later than the images", {delay("0.1"), from("0"), to("inf")}, lateImu},
      {"clock_offset",
       "the cameras' clock is off against the IMU's",
       {camera("-1"), number("offset", "0.02", "s", -1e6, 1e6), from("0"), to("inf")},
       clockOffset},
      {"zero_stamps",
       "every n-th stamp is 0",
       {choice("of", "all", {"all", "images", "imu"}), every("7"), from("0"), to("inf")},
       zeroStamps},
      // Cameras
      {"camera_lost", "a camera stops and returns", {camera("1"), from("3"), to("5")}, cameraLost},
      {"camera_late",
       "the images of a camera arrive late",
       {camera("1"), delay("0.2"), from("3"), to("5")},
       lateImages},
      {"image_size",
       "the images change their size",
       {camera("1"), number("scale", "0.5", "", 0.01, 4.0), from("3"), to("5")},
       imageSize},
      {"image_encoding",
       "the raw images change their encoding",
       {camera("-1"), choice("encoding", "bgr8", {"mono8", "mono16", "bgr8", "rgb8", "unknown"}), from("3"), to("5")},
       imageEncoding},
      {"image_blank",
       "one grey level all over",
       {camera("-1"), number("grey", "128", "grey levels", 0.0, 255.0), from("3"), to("4")},
       imageBlank},
      {"image_dark",
       "hardly any light",
       {camera("-1"), number("factor", "0.02", "", 0.0, 1.0), from("3"), to("4")},
       imageGain},
      {"image_saturated",
       "far too much light",
       {camera("-1"), number("factor", "10", "", 1.0, 1000.0), from("3"), to("4")},
       imageGain},
      {"image_noise",
       "white noise on the images",
       {camera("-1"), number("sigma", "30", "grey levels", 0.0, 255.0), from("3"), to("4")},
       imageNoise},
      {"image_frozen",
       "the same picture again and again, with new stamps",
       {camera("-1"), from("3"), to("4")},
       imageFrozen},
      {"image_truncated",
       "the end of the image data is missing",
       {camera("1"), number("keep", "0.5", "share", 0.0, 1.0), from("3"), to("5")},
       imageTruncated},
      {"obstruction",
       "a grey rectangle before the camera; x, y, width, height are shares of the image",
       {camera("0"), number("x", "0", "share", 0.0, 1.0), number("y", "0", "share", 0.0, 1.0),
        number("width", "0.7", "share", 0.0, 1.0), number("height", "1", "share", 0.0, 1.0),
        number("grey", "40", "grey levels", 0.0, 255.0), from("3"), to("5")},
       obstruction},
      {"moving_object",
       "a textured rectangle that crosses the image; size is a share of the image",
       {camera("-1"), number("size", "0.5", "share", 0.0, 1.0), number("speed", "150", "px/s", 0.0, 1e5), from("3"),
        to("5")},
       movingObject},
      {"exposure_steps",
       "the brightness jumps up and down",
       {camera("-1"), number("factor", "2.5", "", 0.0, 1000.0), number("period", "0.4", "s", 1e-3, 1e6), from("3"),
        to("5")},
       exposureSteps},
      {"camera_info_absent", "no CameraInfo", {camera("1"), from("0"), to("inf")}, cameraInfoAbsent},
      {"camera_info_zero",
       "CameraInfo of zeros, as of an uncalibrated camera",
       {camera("1"), from("0"), to("inf")},
       cameraInfoZero},
      {"camera_info_mismatch",
       "CameraInfo of another image size",
       {camera("1"), number("scale", "0.5", "", 0.01, 100.0), from("0"), to("inf")},
       cameraInfoMismatch},
      {"shared_frame_id", "one frame_id for all cameras", {}, sharedFrameId},
      // IMU
      {"imu_gap", "no IMU samples for a moment", {from("3"), to("3.3")}, imuLost},
      {"imu_silent", "the IMU stops", {from("3"), to("inf")}, imuLost},
      {"imu_frozen", "the same values again and again, with new stamps", {from("3"), to("4")}, imuFrozen},
      {"imu_nan", "every n-th IMU sample is not a number", {sensor(), every("5"), from("3"), to("4")}, imuNan},
      {"imu_saturated",
       "IMU values cut at the end of the range",
       {number("gyroscope", "0.3", "rad/s", 0.0, 1e6), number("accelerometer", "9.9", "m/s^2", 0.0, 1e6), from("3"),
        to("4")},
       imuSaturated},
      {"imu_g_units", "accelerations in g, not in m/s^2", {from("0"), to("inf")}, imuInG},
      {"imu_swapped_axes",
       "two axes of the IMU changed for one another",
       {choice("axes", "xy", {"xy", "yz", "zx"}), sensor(), from("0"), to("inf")},
       imuSwappedAxes},
      {"imu_rate", "fewer IMU samples", {number("rate", "10", "Hz", 1e-3, 1e6), from("0"), to("inf")}, imuRate},
      {"imu_bias",
       "IMU values off by a constant on every axis",
       {number("gyroscope", "0.1", "rad/s", -1e3, 1e3), number("accelerometer", "0.5", "m/s^2", -1e3, 1e3), from("0"),
        to("inf")},
       imuBias},
      {"imu_orientation",
       "identity orientation with zero covariance, as of a driver that has none",
       {from("0"), to("inf")},
       imuOrientation},
  };
  return kinds;
}

std::string faultList() {
  std::ostringstream list;
  for (const FaultKind& kind : faultKinds()) {
    list << kind.name;
    for (const FaultParameter& parameter : kind.parameters) {
      list << "  " << parameter.name << "=" << parameter.default_value;
      std::string unit = parameter.unit;
      for (const std::string& one : parameter.choices) unit += (unit.empty() ? "" : "|") + one;
      if (!unit.empty()) list << " [" << unit << "]";
    }
    list << "  (" << kind.summary << ")\n";
  }
  return list.str();
}

FaultRequest parseFault(const std::string& text) {
  const std::size_t colon = text.find(':');
  const std::string name = text.substr(0, colon);
  const std::vector<FaultKind>& kinds = faultKinds();
  const auto kind = std::find_if(kinds.begin(), kinds.end(), [&](const FaultKind& one) { return one.name == name; });
  if (kind == kinds.end()) {
    std::string known;
    for (const FaultKind& one : kinds) known += (known.empty() ? "" : ", ") + one.name;
    throw std::invalid_argument("found fault '" + name + "', expected one of " + known);
  }
  return {&*kind, FaultValues(name, kind->parameters, colon == std::string::npos ? "" : text.substr(colon + 1))};
}

}  // namespace multicam_egomotion
