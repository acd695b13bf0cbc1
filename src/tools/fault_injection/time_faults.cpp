// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "fault_injection/time_faults.h"

#include <boost/make_shared.hpp>
#include <stdexcept>

namespace multicam_egomotion {
namespace {

void shiftStamp(RecordedMessage* message, double seconds) {
  changeHeader(message, [seconds](std_msgs::Header* header) {
    if (header->stamp.toSec() + seconds < 0.0) {
      throw std::runtime_error("a stamp of " + std::to_string(header->stamp.toSec()) + " s cannot go " +
                               std::to_string(-seconds) + " s back");
    }
    header->stamp += ros::Duration(seconds);
  });
}

using Chooser = bool (FaultSetting::*)(const RecordedMessage&) const;

/// Every n-th chosen message also, or only, arrives `delay` later.
Fault delayed(const FaultSetting& setting, Chooser chosen, int every, bool twice) {
  return [setting, chosen, next = EveryNth(every), twice](RecordedMessage message, const Emit& emit) mutable {
    if ((setting.*chosen)(message) && next()) {
      if (twice) emit(message);
      message.arrival += ros::Duration(setting.values.number("delay"));
    }
    emit(std::move(message));
  };
}

}  // namespace

Fault timeJump(const FaultSetting& setting) {
  return [setting](RecordedMessage message, const Emit& emit) {
    if (setting.since(message, "at") >= 0.0) shiftStamp(&message, setting.values.number("by"));
    emit(std::move(message));
  };
}

Fault timeGap(const FaultSetting& setting) {
  return [setting](RecordedMessage message, const Emit& emit) {
    if (!setting.active(message) || (!isImage(message) && !isCameraInfo(message) && !isImu(message))) {
      emit(std::move(message));
    }
  };
}

Fault bagLoop(const FaultSetting& setting) {
  return [setting](RecordedMessage message, const Emit& emit) {
    const ros::Duration lap = setting.layout.end - setting.layout.begin + ros::Duration(setting.values.number("pause"));
    for (int i = setting.values.integer("times"); i > 0; --i) {
      emit(message);
      message.arrival += lap;
    }
  };
}

Fault duplicateImages(const FaultSetting& setting) {
  return delayed(setting, &FaultSetting::activeImage, setting.values.integer("every"), true);
}

Fault duplicateImu(const FaultSetting& setting) {
  return delayed(setting, &FaultSetting::activeImu, setting.values.integer("every"), true);
}

Fault outOfOrderImages(const FaultSetting& setting) {
  return delayed(setting, &FaultSetting::activeImage, setting.values.integer("every"), false);
}

Fault outOfOrderImu(const FaultSetting& setting) {
  return delayed(setting, &FaultSetting::activeImu, setting.values.integer("every"), false);
}

Fault lateImages(const FaultSetting& setting) { return delayed(setting, &FaultSetting::activeImage, 1, false); }

Fault lateImu(const FaultSetting& setting) { return delayed(setting, &FaultSetting::activeImu, 1, false); }

Fault clockOffset(const FaultSetting& setting) {
  return [setting](RecordedMessage message, const Emit& emit) {
    if (setting.activeImage(message) || setting.activeCameraInfo(message)) {
      shiftStamp(&message, setting.values.number("offset"));
    }
    emit(std::move(message));
  };
}

Fault zeroStamps(const FaultSetting& setting) {
  return
      [setting, next = EveryNth(setting.values.integer("every"))](RecordedMessage message, const Emit& emit) mutable {
        const std::string& of = setting.values.text("of");
        const bool chosen = (isImage(message) && of != "imu") || (isImu(message) && of != "images");
        if (chosen && setting.active(message) && next()) {
          changeHeader(&message, [](std_msgs::Header* header) { header->stamp = ros::Time(); });
        }
        emit(std::move(message));
      };
}

}  // namespace multicam_egomotion
