// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "fault_injection/camera_faults.h"

#include <cv_bridge/cv_bridge.h>

#include <boost/make_shared.hpp>
#include <cmath>

namespace multicam_egomotion {
namespace {

/// A fault that changes the CameraInfo of a camera.
Fault changedCameraInfo(const FaultSetting& setting, std::function<void(sensor_msgs::CameraInfo*)> change) {
  return [setting, change](RecordedMessage message, const Emit& emit) {
    if (setting.activeCameraInfo(message)) {
      const auto info = copyOf<sensor_msgs::CameraInfo>(message);
      change(info.get());
      message.content = sensor_msgs::CameraInfoConstPtr(info);
    }
    emit(std::move(message));
  };
}

}  // namespace

Fault cameraLost(const FaultSetting& setting) {
  return [setting](RecordedMessage message, const Emit& emit) {
    if (!setting.activeImage(message) && !setting.activeCameraInfo(message)) emit(std::move(message));
  };
}

Fault imageEncoding(const FaultSetting& setting) {
  return [setting](RecordedMessage message, const Emit& emit) {
    if (setting.activeImage(message) && std::holds_alternative<sensor_msgs::ImageConstPtr>(message.content)) {
      const std::string& encoding = setting.values.text("encoding");
      if (encoding == "unknown") {
        const auto image = copyOf<sensor_msgs::Image>(message);
        image->encoding = encoding;
        message.content = sensor_msgs::ImageConstPtr(image);
      } else {
        const auto& image = std::get<sensor_msgs::ImageConstPtr>(message.content);
        message.content = sensor_msgs::ImageConstPtr(cv_bridge::toCvCopy(image, encoding)->toImageMsg());
      }
    }
    emit(std::move(message));
  };
}

Fault imageTruncated(const FaultSetting& setting) {
  return [setting](RecordedMessage message, const Emit& emit) {
    if (setting.activeImage(message)) {
      const auto truncate = [&](auto image) {
        image->data.resize(static_cast<std::size_t>(setting.values.number("keep") * image->data.size()));
        message.content = image;
      };
      if (std::holds_alternative<sensor_msgs::ImageConstPtr>(message.content)) {
        truncate(copyOf<sensor_msgs::Image>(message));
      } else {
        truncate(copyOf<sensor_msgs::CompressedImage>(message));
      }
    }
    emit(std::move(message));
  };
}

Fault cameraInfoAbsent(const FaultSetting& setting) {
  return [setting](RecordedMessage message, const Emit& emit) {
    if (!setting.activeCameraInfo(message)) emit(std::move(message));
  };
}

Fault cameraInfoZero(const FaultSetting& setting) {
  return changedCameraInfo(setting, [](sensor_msgs::CameraInfo* info) {
    const std_msgs::Header header = info->header;
    *info = sensor_msgs::CameraInfo();
    info->header = header;
  });
}

Fault cameraInfoMismatch(const FaultSetting& setting) {
  const double scale = setting.values.number("scale");
  return changedCameraInfo(setting, [scale](sensor_msgs::CameraInfo* info) {
    info->width = static_cast<std::uint32_t>(std::lround(scale * info->width));
    info->height = static_cast<std::uint32_t>(std::lround(scale * info->height));
    for (int i = 0; i < 6; ++i) info->K[i] *= scale;
    for (int i = 0; i < 8; ++i) info->P[i] *= scale;
  });
}

Fault sharedFrameId(const FaultSetting&) {
  return [frame_id = std::string()](RecordedMessage message, const Emit& emit) mutable {
    if (isImage(message) || isCameraInfo(message)) {
      changeHeader(&message, [&](std_msgs::Header* header) {
        if (frame_id.empty()) frame_id = header->frame_id;
        header->frame_id = frame_id;
      });
    }
    emit(std::move(message));
  };
}

}  // namespace multicam_egomotion
