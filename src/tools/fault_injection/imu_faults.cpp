// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "fault_injection/imu_faults.h"

#include <algorithm>
#include <boost/make_shared.hpp>
#include <limits>
#include <utility>

namespace multicam_egomotion {
namespace {

constexpr double kStandardGravity = 9.80665;  // [m/s^2]

Fault changedImu(const FaultSetting& setting, std::function<void(sensor_msgs::Imu*)> change) {
  return [setting, change](RecordedMessage message, const Emit& emit) {
    if (setting.activeImu(message)) {
      const auto sample = copyOf<sensor_msgs::Imu>(message);
      change(sample.get());
      message.content = sensor_msgs::ImuConstPtr(sample);
    }
    emit(std::move(message));
  };
}

void setAll(geometry_msgs::Vector3* v, const std::function<double(double)>& value) {
  v->x = value(v->x);
  v->y = value(v->y);
  v->z = value(v->z);
}

}  // namespace

Fault imuLost(const FaultSetting& setting) {
  return [setting](RecordedMessage message, const Emit& emit) {
    if (!setting.activeImu(message)) emit(std::move(message));
  };
}

Fault imuFrozen(const FaultSetting& setting) {
  return changedImu(setting, [first = std::make_shared<sensor_msgs::ImuConstPtr>()](sensor_msgs::Imu* sample) {
    if (*first == nullptr) *first = boost::make_shared<sensor_msgs::Imu>(*sample);
    const std_msgs::Header header = sample->header;
    *sample = **first;
    sample->header = header;
  });
}

Fault imuNan(const FaultSetting& setting) {
  const auto next = std::make_shared<EveryNth>(setting.values.integer("every"));
  const std::string sensor = setting.values.text("sensor");
  return changedImu(setting, [next, sensor](sensor_msgs::Imu* sample) {
    if (!(*next)()) return;
    const auto nan = [](double) { return std::numeric_limits<double>::quiet_NaN(); };
    if (sensor != "accelerometer") setAll(&sample->angular_velocity, nan);
    if (sensor != "gyroscope") setAll(&sample->linear_acceleration, nan);
  });
}

Fault imuSaturated(const FaultSetting& setting) {
  const double rate = setting.values.number("gyroscope"), acceleration = setting.values.number("accelerometer");
  return changedImu(setting, [rate, acceleration](sensor_msgs::Imu* sample) {
    setAll(&sample->angular_velocity, [rate](double value) { return std::clamp(value, -rate, rate); });
    setAll(&sample->linear_acceleration,
           [acceleration](double value) { return std::clamp(value, -acceleration, acceleration); });
  });
}

Fault imuInG(const FaultSetting& setting) {
  return changedImu(setting, [](sensor_msgs::Imu* sample) {
    setAll(&sample->linear_acceleration, [](double value) { return value / kStandardGravity; });
  });
}

Fault imuSwappedAxes(const FaultSetting& setting) {
  const std::string axes = setting.values.text("axes"), sensor = setting.values.text("sensor");
  const auto swapAxes = [axes](geometry_msgs::Vector3* v) {
    if (axes == "xy") std::swap(v->x, v->y);
    if (axes == "yz") std::swap(v->y, v->z);
    if (axes == "zx") std::swap(v->z, v->x);
  };
  return changedImu(setting, [swapAxes, sensor](sensor_msgs::Imu* sample) {
    if (sensor != "accelerometer") swapAxes(&sample->angular_velocity);
    if (sensor != "gyroscope") swapAxes(&sample->linear_acceleration);
  });
}

Fault imuRate(const FaultSetting& setting) {
  const ros::Duration period(1.0 / setting.values.number("rate"));
  const ros::Duration jitter(0.01 * period.toSec());
  return [setting, period, jitter, next = ros::Time()](RecordedMessage message, const Emit& emit) mutable {
    if (setting.activeImu(message)) {
      if (message.recorded + jitter < next) return;
      if (next.isZero() || message.recorded > next + period) next = message.recorded;
      next += period;
    }
    emit(std::move(message));
  };
}

Fault imuBias(const FaultSetting& setting) {
  const double rate = setting.values.number("gyroscope"), acceleration = setting.values.number("accelerometer");
  return changedImu(setting, [rate, acceleration](sensor_msgs::Imu* sample) {
    setAll(&sample->angular_velocity, [rate](double value) { return value + rate; });
    setAll(&sample->linear_acceleration, [acceleration](double value) { return value + acceleration; });
  });
}

Fault imuOrientation(const FaultSetting& setting) {
  return changedImu(setting, [](sensor_msgs::Imu* sample) {
    sample->orientation = geometry_msgs::Quaternion();
    sample->orientation.w = 1.0;
    sample->orientation_covariance.assign(0.0);
  });
}

}  // namespace multicam_egomotion
