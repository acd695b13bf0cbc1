// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include <vector>

#include "paper_experiments/csv_file.h"
#include "paper_experiments/experiments.h"
#include "paper_experiments/parallel.h"
#include "paper_experiments/pose_errors.h"
#include "paper_experiments/two_camera_trial.h"

namespace multicam_egomotion {
namespace {

constexpr int kBlock = 10;  // runs that are timed together: reading the clock costs tens of nanoseconds

}  // namespace

void runRuntimeExperiment(const ExperimentOptions& options) {
  const int blocks = options.solverRuns() / kBlock;
  std::vector<SolverProblem> problems(blocks * kBlock);
  forEachInParallel("Table I: problems", problems.size(), options.threads, [&](std::size_t i) {
    problems[i] = TwoCameraTrial(TwoCameraMotion::kRandom, options.seed, i).problem({}, AxisNoise::kTurned);
  });
  CsvFile csv(options.out + "/table1_runtime.csv", "solver,runs,mean_us,median_us");
  for (const PaperSolver& solver : paperSolvers()) {
    std::vector<double> microseconds(blocks);
    solver.time(problems.data(), kBlock);  // warms the caches
    forEachInParallel("Table I: " + solver.name, blocks, 1, [&](std::size_t block) {
      microseconds[block] = 1e6 * solver.time(&problems[block * kBlock], kBlock) / kBlock;
    });
    double sum = 0.0;
    for (const double time : microseconds) sum += time;
    csv.row(solver.name, problems.size(), sum / blocks, median(microseconds));
  }
}

}  // namespace multicam_egomotion
