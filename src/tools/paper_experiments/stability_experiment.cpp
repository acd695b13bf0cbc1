// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "paper_experiments/csv_file.h"
#include "paper_experiments/experiments.h"
#include "paper_experiments/parallel.h"
#include "paper_experiments/trial_errors.h"

namespace multicam_egomotion {
namespace {

constexpr double kLowest = -18.0, kHighest = 1.0, kBin = 0.25;  // of log10 of an error [rad]
constexpr double kFailure = 1e-6;                               // [rad]

// An error of zero counts as the smallest.
double logarithm(double error) { return std::max(std::log10(error), kLowest); }

void writeDensity(const std::string& solver, const std::string& error, const std::vector<double>& logarithms,
                  CsvFile* csv) {
  const int bins = static_cast<int>(std::lround((kHighest - kLowest) / kBin));
  std::vector<int> counts(bins);
  for (const double value : logarithms) ++counts[std::clamp(static_cast<int>((value - kLowest) / kBin), 0, bins - 1)];
  for (int bin = 0; bin < bins; ++bin) {
    csv->row(solver, error, kLowest + (bin + 0.5) * kBin,
             counts[bin] / (kBin * static_cast<double>(logarithms.size())));
  }
}

}  // namespace

void runStabilityExperiment(const ExperimentOptions& options) {
  const std::vector<PaperSolver>& solvers = paperSolvers();
  const std::size_t runs = options.solverRuns();
  std::vector<std::vector<PoseErrors>> errors(solvers.size(), std::vector<PoseErrors>(runs));
  forEachInParallel("Fig. 3: numerical stability", runs, options.threads, [&](std::size_t i) {
    const TwoCameraTrial trial(TwoCameraMotion::kRandom, options.seed, i);
    const SolverProblem problem = trial.problem({}, AxisNoise::kTurned);
    for (std::size_t s = 0; s < solvers.size(); ++s) {
      errors[s][i] = trialErrors(solvers[s], problem, trial, nullptr).nearest;
    }
  });

  CsvFile densities(options.out + "/fig3_stability.csv", "solver,error,log10_rad,density");
  CsvFile quantiles(options.out + "/fig3_quantiles.csv",
                    "solver,error,runs,log10_median,log10_p99,log10_p99.9,failures");
  for (std::size_t s = 0; s < solvers.size(); ++s) {
    for (const bool rotation : {true, false}) {
      std::vector<double> logarithms;
      for (const PoseErrors& one : errors[s])
        logarithms.push_back(logarithm(rotation ? one.rotation : one.translation));
      const std::string error = rotation ? "rotation" : "translation";
      writeDensity(solvers[s].name, error, logarithms, &densities);
      const auto failures =
          std::count_if(logarithms.begin(), logarithms.end(), [](double x) { return x > std::log10(kFailure); });
      quantiles.row(solvers[s].name, error, runs, median(logarithms), quantile(logarithms, 0.99),
                    quantile(logarithms, 0.999), static_cast<int>(failures));
    }
  }
}

}  // namespace multicam_egomotion
