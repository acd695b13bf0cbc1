// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "bag_runner/command_line.h"

#include <boost/program_options.hpp>
#include <iostream>
#include <stdexcept>

namespace multicam_egomotion {

bool parseCommandLine(int argc, char** argv, BagCommand* command) {
  namespace po = boost::program_options;
  po::options_description options("egomotion_bag: odometry of a bag, as fast as the machine can\n\nOptions");
  const auto path = [](std::string* value) { return po::value<std::string>(value)->value_name("FILE"); };
  options.add_options()                                           //
      ("help,h", "this text")                                     //
      ("bag", path(&command->bag)->required(), "images and IMU")  //
      ("rig", path(&command->rig),
       "rig YAML or Kalibr's camchain-imucam.yaml; without: CameraInfo and TF of the bag")                     //
      ("rig-imu", path(&command->rig_imu), "Kalibr's imu.yaml")                                                //
      ("config", path(&command->config), "parameter YAML of the nodelet; what it leaves out has its default")  //
      ("imu-topic", po::value<std::string>(&command->imu_topic)->value_name("TOPIC"), "instead of the rig's")  //
      ("trajectory", path(&command->trajectory), "TUM: body in odom at each image stamp")                      //
      ("kitti", path(&command->kitti), "KITTI: camera 0 relative to its first pose, a line an image pair")     //
      ("report", path(&command->report), "JSON: counts, times of the stages, calibration, CPU and memory")     //
      ("output-bag", path(&command->output_bag), "odometry, relative_pose, ego_motion, calibration and /tf")   //
      ("write-rig", path(&command->write_rig), "rig YAML of this run with the estimated rotations of the cameras");
  try {
    po::variables_map values;
    po::store(po::command_line_parser(argc, argv).options(options).run(), values);
    if (values.count("help") > 0) {
      std::cout << options;
      return false;
    }
    po::notify(values);
  } catch (const po::error& error) {
    throw std::invalid_argument(std::string(error.what()) + " (see --help)");
  }
  return true;
}

}  // namespace multicam_egomotion
