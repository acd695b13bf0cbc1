// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
// Applies faults to a bag, so that one can see what the odometry, or any other node, makes of them. Exit code 2 on a
// wrong name or value, 1 when a bag cannot be read or written.
#include <rosbag/exceptions.h>

#include <boost/program_options.hpp>
#include <cstdio>
#include <exception>
#include <iostream>
#include <stdexcept>

#include "fault_injection/corrupted_bag.h"

namespace {

using namespace multicam_egomotion;

struct Command {
  std::string input, output;
  std::vector<FaultRequest> faults;
  std::uint64_t seed = 1;
};

/// False when only a text was wanted, which has been printed. Throws std::invalid_argument.
bool parseCommandLine(int argc, char** argv, Command* command) {
  namespace po = boost::program_options;
  std::vector<std::string> faults;
  po::options_description visible("Options");
  visible.add_options()("help,h", "this text")("list", "one fault a line: its parameters with default and unit")(
      "fault", po::value(&faults)->composing()->value_name("NAME[:PARAMETER=VALUE,...]"),
      "repeat for several; each works on what the one before leaves. from, to, at: seconds since the bag's begin")(
      "seed", po::value(&command->seed)->default_value(command->seed), "of noise and textures");
  po::options_description all;
  all.add(visible).add_options()("input", po::value(&command->input))("output", po::value(&command->output));
  po::positional_options_description positions;
  positions.add("input", 1).add("output", 1);
  try {
    po::variables_map values;
    po::store(po::command_line_parser(argc, argv).options(all).positional(positions).run(), values);
    po::notify(values);
    if (values.count("list") > 0) {
      std::cout << faultList();
      return false;
    }
    if (values.count("help") > 0) {
      std::cout
          << "corrupt_bag IN.bag OUT.bag --fault camera_lost:camera=1,from=3.0,to=5.0 [--fault ...] [--seed N]\n\n"
          << visible;
      return false;
    }
  } catch (const po::error& error) {
    throw std::invalid_argument(std::string(error.what()) + " (see --help)");
  }
  if (command->input.empty() || command->output.empty() || faults.empty()) {
    throw std::invalid_argument("expected IN.bag OUT.bag --fault NAME (see --help and --list)");
  }
  for (const std::string& fault : faults) command->faults.push_back(parseFault(fault));
  return true;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    ros::Time::init();
    Command command;
    if (!parseCommandLine(argc, argv, &command)) return 0;
    corruptBag(command.input, command.output, command.faults, command.seed);
    return 0;
  } catch (const std::invalid_argument& error) {
    std::fprintf(stderr, "corrupt_bag: %s\n", error.what());
    return 2;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "corrupt_bag: %s\n", error.what());
    return 1;
  }
}
