// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "multicam_egomotion/ros/rig_setup.h"

#include <opencv2/imgcodecs.hpp>
#include <stdexcept>

#include "multicam_egomotion/odometry/rig_file.h"

namespace multicam_egomotion {

RigTopics defaultTopics(int cameras, const std::string& base_frame) {
  RigTopics topics;
  for (int i = 0; i < cameras; ++i) {
    const std::string camera = "cam" + std::to_string(i);
    topics.images.push_back(camera + "/image_raw");
    topics.camera_infos.push_back(camera + "/camera_info");
  }
  topics.imu = "imu";
  topics.base_frame = base_frame.empty() ? "base_link" : base_frame;
  return topics;
}

RigSetup loadRigSetup(const Parameters& parameters, RigTopics* topics) {
  const NodeOptions& node = parameters.node;
  try {
    const RigFile file = loadRigFile(node.rig_file, node.rig_imu_file);
    if (parameters.odometry.use_imu && !file.has_imu) {
      throw std::invalid_argument("'" + node.rig_file +
                                  "': found no imu, expected one, or the parameter use_imu: false");
    }
    *topics = defaultTopics(file.rig.size(), node.base_frame.empty() ? file.body_frame : node.base_frame);
    for (int i = 0; i < file.rig.size(); ++i) {
      if (!file.image_topics[i].empty()) topics->images[i] = file.image_topics[i];
      if (!file.camera_info_topics[i].empty()) topics->camera_infos[i] = file.camera_info_topics[i];
    }
    if (!file.imu.topic.empty()) topics->imu = file.imu.topic;
    return {file.rig, file.imu};
  } catch (const std::runtime_error& error) {
    throw std::invalid_argument(std::string("parameter 'rig_file': ") + error.what());
  }
}

std::unique_ptr<EgoMotion> makeEgoMotion(const RigSetup& setup, const Parameters& parameters) {
  auto odometry = std::make_unique<EgoMotion>(setup.rig, setup.imu, parameters.odometry);
  const std::vector<std::string>& masks = parameters.node.mask_files;
  if (!masks.empty() && static_cast<int>(masks.size()) != setup.rig.size()) {
    throw std::invalid_argument("parameter 'mask_files': found " + std::to_string(masks.size()) + " files, expected " +
                                std::to_string(setup.rig.size()) + ", one a camera ('' for none)");
  }
  for (std::size_t i = 0; i < masks.size(); ++i) {
    if (masks[i].empty()) continue;
    const cv::Mat mask = cv::imread(masks[i], cv::IMREAD_GRAYSCALE);
    if (mask.empty()) {
      throw std::invalid_argument("parameter 'mask_files': found '" + masks[i] +
                                  "', expected an image that can be read");
    }
    odometry->setMask(static_cast<int>(i), mask);
  }
  return odometry;
}

}  // namespace multicam_egomotion
