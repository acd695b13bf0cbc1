// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause

// Every table and figure of the paper's section V, one CSV file each.

#include <algorithm>
#include <boost/program_options.hpp>
#include <exception>
#include <filesystem>
#include <iostream>
#include <stdexcept>
#include <thread>

#include "paper_experiments/experiments.h"

namespace {

using namespace multicam_egomotion;

void requireAtLeast(const char* name, int found, int least) {
  if (found >= least) return;
  throw std::invalid_argument(std::string("--") + name + ": found " + std::to_string(found) + ", expected at least " +
                              std::to_string(least));
}

}  // namespace

int main(int argc, char** argv) {
  namespace po = boost::program_options;
  ExperimentOptions options;
  int threads = 0;
  po::options_description description("paper_experiments: the tables and figures of the paper as CSV\n\nOptions");
  const auto number = [](auto* value) { return po::value(value)->default_value(*value)->value_name("N"); };
  description.add_options()("help,h", "this text")("out", po::value(&options.out)->required()->value_name("DIR"),
                                                   "for the CSV files")(
      "trials", number(&options.trials), "of each point of Figs. 4 to 6; Table I and Fig. 3 take ten times as many")(
      "data", po::value(&options.data)->value_name("DIR"),
      "searched for KITTI: odometry folders (sequences/NN, poses/NN.txt) and drives with tracks.csv")(
      "frames", number(&options.frames), "at most of each KITTI sequence, 0: all")(
      "ransac-seeds", number(&options.ransac_seeds), "over which medians of KITTI are taken")(
      "seed", number(&options.seed), "of all random numbers")("threads", number(&threads),
                                                              "0: one a processor core; changes no result");
  try {
    po::variables_map values;
    po::store(po::parse_command_line(argc, argv, description), values);
    if (values.count("help") > 0) {
      std::cout << description;
      return 0;
    }
    po::notify(values);
    requireAtLeast("trials", options.trials, 1);
    requireAtLeast("threads", threads, 0);
    requireAtLeast("ransac-seeds", options.ransac_seeds, 1);
    if (options.frames != 0) requireAtLeast("frames", options.frames, 2);
    options.threads = threads > 0 ? threads : static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
    std::filesystem::create_directories(options.out);
    runRuntimeExperiment(options);
    runStabilityExperiment(options);
    runNoiseExperiments(options);
    runKittiExperiments(options);
  } catch (const std::exception& error) {
    std::cerr << "paper_experiments: " << error.what() << "\n";
    return 1;
  }
  return 0;
}
