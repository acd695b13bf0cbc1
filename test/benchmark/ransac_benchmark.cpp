// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
//
// ransac/<solver>/outliers:<percent>: from sampling to covariance, on 500 correspondences of two cameras (RobustTrial)
// in random, forward and sideways motion; layout of the correspondences, scoring and refinement apart.
// accuracy/<solver>/<correspondences>/outliers:<percent>/<motion>: 1000 trials beside an oracle, the same refinement
// started at the truth on the true inliers. Counters: median and 90 % quantile of the errors of rotation, direction and
// scale over the oracle's; failures that the oracle does not have; mean squared error in sigmas over the six unknowns;
// median time of an estimate.
#include <benchmark/benchmark.h>

#include <chrono>
#include <string>
#include <vector>

#include "../unit/robust_trials.h"
#include "multicam_egomotion/estimation/two_view_normal_equations.h"

namespace multicam_egomotion {
namespace {

constexpr Motion kMotions[] = {Motion::kRandom, Motion::kForward, Motion::kSideways};
constexpr const char* kMotionNames[] = {"random", "forward", "sideways"};
constexpr int kTrials = 1000;

RobustEstimatorOptions optionsOfTrials() {
  RobustEstimatorOptions options;
  options.max_samples = 2000;  // 60 % outliers ask for 355
  return options;
}

const VerticalPrior& priorOf(const RobustTrial& trial, FourPointVertical) { return trial.vertical; }
const AxisPrior& priorOf(const RobustTrial& trial, FourPointAxis) { return trial.axis; }

std::vector<RobustTrial> trialsOf(double outliers, int count) {
  std::vector<RobustTrial> trials;
  for (int i = 0; i < count; ++i) {
    TrialSetup setup;
    setup.outliers = outliers;
    setup.motion = kMotions[i % 3];
    trials.push_back(makeRobustTrial(setup, 1 + i));
  }
  return trials;
}

template <class Solver>
void estimateTrials(benchmark::State& state, double outliers) {
  const std::vector<RobustTrial> trials = trialsOf(outliers, 60);
  std::vector<CorrespondenceSet> sets;
  for (const RobustTrial& trial : trials) sets.push_back(trial.set());
  const RobustEstimatorOptions options = optionsOfTrials();
  std::size_t frame = 0;
  double samples = 0.0, models = 0.0, refinements = 0.0, failures = 0.0;
  for (auto _ : state) {
    const std::size_t i = frame++ % trials.size();
    const RobustEstimate found = estimate<Solver>(sets[i], priorOf(trials[i], Solver()), {}, options, frame);
    benchmark::DoNotOptimize(found.score);
    samples += found.samples;
    models += found.models;
    refinements += found.refinements;
    failures += !found.success || poseErrors(found.R, found.t, trials[i]).failed();
  }
  state.counters["samples"] = samples / frame;
  state.counters["models"] = models / frame;
  state.counters["refinements"] = refinements / frame;
  state.counters["failures"] = failures / frame;
}

template <class Solver>
void compareWithOracle(benchmark::State& state, const TrialSetup& setup) {
  const RobustEstimatorOptions options = optionsOfTrials();
  OracleComparison comparison;
  std::vector<double> times;
  for (auto _ : state) {
    for (int i = 0; i < kTrials; ++i) {
      const RobustTrial trial = makeRobustTrial(setup, 1 + i);
      const CorrespondenceSet set = trial.set();
      const auto start = std::chrono::steady_clock::now();
      const RobustEstimate found = estimate<Solver>(set, priorOf(trial, Solver()), {}, options, i);
      const std::chrono::duration<double, std::micro> time = std::chrono::steady_clock::now() - start;
      times.push_back(time.count());
      comparison.add(found, trial, oracleEstimate(trial, {}, options));
    }
  }
  for (const auto& [name, share] : {std::make_pair("median", 0.5), std::make_pair("p90", 0.9)}) {
    const auto ratio = [share = share](const std::vector<double>& ours, const std::vector<double>& oracle) {
      return quantile(ours, share) / quantile(oracle, share);
    };
    state.counters[std::string("rotation_") + name] = ratio(comparison.rotation, comparison.oracle_rotation);
    state.counters[std::string("direction_") + name] = ratio(comparison.direction, comparison.oracle_direction);
    state.counters[std::string("scale_") + name] = ratio(comparison.scale, comparison.oracle_scale);
  }
  state.counters["failures"] = comparison.failures;
  state.counters["nees"] = comparison.nees();
  state.counters["median_us"] = quantile(times, 0.5);
}

void layOut(benchmark::State& state) {
  const RobustTrial trial = makeRobustTrial({}, 1);
  for (auto _ : state) benchmark::DoNotOptimize(trial.set().size());
}

void score(benchmark::State& state) {
  const RobustTrial trial = makeRobustTrial({}, 1);
  const CorrespondenceSet set = trial.set();
  for (auto _ : state) {
    benchmark::DoNotOptimize(set.sumOfLosses(trial.R, trial.t, {0.5, 2.0}, CorrespondenceSet::Part::kAll));
  }
  state.counters["correspondences"] = set.size();
}

template <class T>
void linearize(benchmark::State& state, const RayBlocks<T>& rays, const RobustTrial& trial) {
  for (auto _ : state) {
    benchmark::DoNotOptimize(linearizeTwoView(rays, false, {{1.0, 2.0}, 0.5}, {}, trial.R, trial.t).cost);
  }
}

void linearizeSingle(benchmark::State& state) {
  const RobustTrial trial = makeRobustTrial({}, 1);
  const CorrespondenceSet set = trial.set();
  linearize(state, set.blocks(), trial);
}

void linearizeDouble(benchmark::State& state) {
  const RobustTrial trial = makeRobustTrial({}, 1);
  const CorrespondenceSet set = trial.set();
  linearize(state, set.weightedBlocks(std::vector<double>(set.size(), 1.0)), trial);
}

void refine(benchmark::State& state) {
  const RobustTrial trial = makeRobustTrial({}, 1);
  const CorrespondenceSet set = trial.inlierSet();
  const RayBlocks<double> rays = set.weightedBlocks(std::vector<double>(set.size(), 1.0));
  TwoViewEstimate start;
  start.R = expSO3(Eigen::Vector3d(0.002, -0.002, 0.001)) * trial.R;
  start.t = trial.t + Eigen::Vector3d(0.01, 0.02, -0.01);
  int iterations = 0;
  for (auto _ : state) iterations = refineTwoView(rays, {}, {}, 2.0, start).iterations;
  state.counters["iterations"] = iterations;
}

template <class Solver>
void registerSolver(const std::string& name) {
  for (const int percent : {0, 30, 60}) {
    const std::string outliers = "/outliers:" + std::to_string(percent);
    benchmark::RegisterBenchmark(("ransac/" + name + outliers).c_str(), [percent](benchmark::State& state) {
      estimateTrials<Solver>(state, 0.01 * percent);
    })->Unit(benchmark::kMicrosecond);
    if (percent == 0) continue;
    for (const bool cross_camera : {false, true}) {
      for (int m = 0; m < 3; ++m) {
        TrialSetup setup;
        setup.outliers = 0.01 * percent;
        setup.cross_camera = cross_camera;
        setup.motion = kMotions[m];
        const std::string full =
            "accuracy/" + name + (cross_camera ? "/cross" : "/intra") + outliers + "/" + kMotionNames[m];
        benchmark::RegisterBenchmark(full.c_str(),
                                     [setup](benchmark::State& state) { compareWithOracle<Solver>(state, setup); })
            ->Iterations(1)
            ->Unit(benchmark::kMillisecond);
      }
    }
  }
}

}  // namespace
}  // namespace multicam_egomotion

int main(int argc, char** argv) {
  using namespace multicam_egomotion;
  registerSolver<FourPointVertical>("4pt-vertical");
  registerSolver<FourPointAxis>("4pt-axis");
  benchmark::RegisterBenchmark("ransac/layout", layOut);
  benchmark::RegisterBenchmark("ransac/score", score);
  benchmark::RegisterBenchmark("ransac/linearize/single", linearizeSingle);
  benchmark::RegisterBenchmark("ransac/linearize/double", linearizeDouble);
  benchmark::RegisterBenchmark("ransac/refine", refine);
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
