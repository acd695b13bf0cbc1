// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <xmlrpcpp/XmlRpcValue.h>

#include <map>
#include <string>
#include <vector>

#include "multicam_egomotion/imu/imu_calibration.h"
#include "multicam_egomotion/odometry/ego_motion_options.h"
#include "multicam_egomotion/ros/node_options.h"

namespace ros {
class NodeHandle;
}

namespace multicam_egomotion {

/// Everything that the nodelet, the node and the bag runner read from parameters; the structs hold the defaults.
struct Parameters {
  NodeOptions node;
  EgoMotionOptions odometry;
  ImuCalibration imu;  ///< noise densities where no rig file gives them; the mounting comes from TF
};

/// Values by full name, groups joined by '/': "tracker/features_per_camera".
using ParameterMap = std::map<std::string, XmlRpc::XmlRpcValue>;

/// All parameters below the handle's namespace.
ParameterMap readParameterServer(const ros::NodeHandle& private_node);
/// The same from the YAML file that roslaunch would load; throws std::invalid_argument (file, line, what is wrong).
ParameterMap readParameterFile(const std::string& path);

/// Overwrites the defaults. Throws std::invalid_argument (name, found, expected) on a wrong type or range. Answers the
/// names that are no parameters of this package.
std::vector<std::string> applyParameters(const ParameterMap& values, Parameters* parameters);

/// The parameters as values by name: the inverse of applyParameters.
ParameterMap parameterValues(const Parameters& parameters);

}  // namespace multicam_egomotion
