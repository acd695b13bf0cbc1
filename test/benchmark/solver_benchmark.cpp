// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
//
// solve/<solver>/<sample>: time per minimal sample, R and t of every solution included, over 4096 different problems
// (rotation up to 10 degrees, at most 3 m). Counters: mean number of solutions; share of samples whose true rotation is
// missed by more than 1e-6 rad (of 4pt-liu, whose solutions are approximate, nearly all). yardstick/companion6: the
// eigenvalues alone of the companion matrices of the same polynomials.
#include <benchmark/benchmark.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <string>
#include <vector>

#include "../unit/five_point_samples.h"
#include "../unit/solver_samples.h"
#include "multicam_egomotion/solvers/five_point_martyushev.h"
#include "multicam_egomotion/solvers/four_point_axis.h"
#include "multicam_egomotion/solvers/four_point_kernel.h"
#include "multicam_egomotion/solvers/four_point_lee.h"
#include "multicam_egomotion/solvers/four_point_liu.h"
#include "multicam_egomotion/solvers/four_point_sweeney.h"
#include "multicam_egomotion/solvers/four_point_vertical.h"
#include "multicam_egomotion/solvers/polynomial_roots.h"

namespace multicam_egomotion {
namespace {

constexpr int kProblems = 4096;

std::vector<SimulatedSample> problems(SampleKind kind) {
  SampleSimulator simulator(1);
  std::vector<SimulatedSample> samples;
  for (int i = 0; i < kProblems; ++i) samples.push_back(simulator.sample(kind, Motion::kRandom, 0, 10 * M_PI / 180));
  return samples;
}

template <typename Sample, typename Solve>
void solveEach(benchmark::State& state, const std::vector<Sample>& samples, const Solve& solve) {
  double solutions = 0, failures = 0;
  for (const Sample& sample : samples) {
    const auto poses = solve(sample);
    solutions += poses.size();
    failures += std::none_of(poses.begin(), poses.end(),
                             [&](const RelativePose& pose) { return rotationError(pose.R, sample.R) < 1e-6; });
  }
  int i = 0;
  for (auto _ : state) {
    auto poses = solve(samples[i]);
    benchmark::DoNotOptimize(poses);
    i = (i + 1) % kProblems;
  }
  state.counters["solutions"] = solutions / kProblems;
  state.counters["failures"] = failures / kProblems;
}

template <typename Solve>
void solveAll(benchmark::State& state, SampleKind kind, const Solve& solve) {
  solveEach(state, problems(kind), solve);
}

void vertical(benchmark::State& state, SampleKind kind) {
  solveAll(state, kind, [](const SimulatedSample& s) { return solveFourPointVertical(s.rays, s.vertical); });
}

void axis(benchmark::State& state, SampleKind kind) {
  solveAll(state, kind, [](const SimulatedSample& s) { return solveFourPointAxis(s.rays, s.axis); });
}

// Eight samples of one motion at a time; counter time_per_sample [s].
template <typename Solve>
void solveBatches(benchmark::State& state, SampleKind kind, const Solve& solve) {
  constexpr int kBatch = 8;
  struct Batch {
    std::array<std::array<RayCorrespondence, 4>, kBatch> samples;
    SimulatedSample motion;
  };
  SampleSimulator simulator(1);
  std::vector<Batch> batches(kProblems / kBatch);
  for (Batch& batch : batches) {
    batch.motion = simulator.sample(kind, Motion::kRandom, 0, 10 * M_PI / 180);
    SimulatedSample sample = batch.motion;
    for (auto& rays : batch.samples) {
      rays = sample.rays;
      simulator.observe(kind, sample);
    }
  }
  std::array<PoseCandidates<6>, kBatch> found;
  double failures = 0;
  for (const Batch& batch : batches) {
    solve(batch.samples.data(), kBatch, batch.motion, found.data());
    for (const auto& poses : found) {
      failures += std::none_of(poses.begin(), poses.end(),
                               [&](const RelativePose& pose) { return rotationError(pose.R, batch.motion.R) < 1e-6; });
    }
  }
  std::size_t i = 0;
  for (auto _ : state) {
    solve(batches[i].samples.data(), kBatch, batches[i].motion, found.data());
    benchmark::DoNotOptimize(found);
    i = (i + 1) % batches.size();
  }
  state.counters["failures"] = failures / kProblems;
  using benchmark::Counter;
  state.counters["time_per_sample"] = Counter(kBatch, Counter::kIsIterationInvariantRate | Counter::kInvert);
}

void verticalBatch(benchmark::State& state, SampleKind kind) {
  solveBatches(state, kind, [](const auto* samples, int count, const SimulatedSample& motion, auto* found) {
    solveFourPointVertical(samples, count, motion.vertical, {}, found);
  });
}

void axisBatch(benchmark::State& state, SampleKind kind) {
  solveBatches(state, kind, [](const auto* samples, int count, const SimulatedSample& motion, auto* found) {
    solveFourPointAxis(samples, count, motion.axis, {}, found);
  });
}

void lee(benchmark::State& state, SampleKind kind) {
  solveAll(state, kind, [](const SimulatedSample& s) { return solveFourPointLee(s.rays, s.vertical); });
}

void sweeney(benchmark::State& state, SampleKind kind) {
  solveAll(state, kind, [](const SimulatedSample& s) { return solveFourPointSweeney(s.rays, s.axis); });
}

void liu(benchmark::State& state, SampleKind kind) {
  solveAll(state, kind, [](const SimulatedSample& s) { return solveFourPointLiu(s.rays, s.vertical); });
}

void martyushev(benchmark::State& state, const FivePointKind& kind) {
  SampleSimulator simulator(1);
  std::vector<FivePointSample> samples;
  for (int i = 0; i < kProblems; ++i) {
    samples.push_back(fivePointSample(simulator, kind.pairs, Motion::kRandom, 0, 10 * M_PI / 180));
  }
  solveEach(state, samples, [](const FivePointSample& s) { return solveFivePointMartyushev(s.rays, s.prior); });
}

std::vector<std::array<double, 7>> polynomials() {
  std::vector<std::array<double, 7>> result;
  for (const SimulatedSample& sample : problems(SampleKind::kIntra22)) {
    result.push_back(
        fourPointPolynomial(sample.rays, {sample.vertical.R_aligned_body1, sample.vertical.R_aligned_body2, false}));
  }
  return result;
}

void companion(benchmark::State& state) {
  using Matrix6d = Eigen::Matrix<double, 6, 6>;
  std::vector<Matrix6d, Eigen::aligned_allocator<Matrix6d>> matrices;
  for (const auto& a : polynomials()) {
    Matrix6d m = Matrix6d::Zero();
    m.diagonal(-1).setOnes();
    for (int k = 0; k < 6; ++k) m(k, 5) = -a[k] / a[6];
    matrices.push_back(m);
  }
  Eigen::EigenSolver<Matrix6d> solver;
  int i = 0;
  for (auto _ : state) {
    solver.compute(matrices[i], false);
    benchmark::DoNotOptimize(solver.eigenvalues());
    i = (i + 1) % kProblems;
  }
}

void realRoots(benchmark::State& state) {
  const auto all = polynomials();
  int i = 0;
  for (auto _ : state) {
    auto roots = findRealRoots(all[i]);
    benchmark::DoNotOptimize(roots);
    i = (i + 1) % kProblems;
  }
}

struct SolverEntry {
  const char* name;
  void (*run)(benchmark::State&, SampleKind);
};

struct SampleEntry {
  const char* name;
  SampleKind kind;
};

constexpr SolverEntry kSolvers[] = {{"4pt-vertical", vertical},
                                    {"4pt-vertical-batch", verticalBatch},
                                    {"4pt-axis", axis},
                                    {"4pt-axis-batch", axisBatch},
                                    {"4pt-lee", lee},
                                    {"4pt-sweeney", sweeney},
                                    {"4pt-liu", liu}};

constexpr SampleEntry kSamples[] = {{"intra_2_2", SampleKind::kIntra22},
                                    {"intra_3_1", SampleKind::kIntra31},
                                    {"intra_2_1_1", SampleKind::kIntra211},
                                    {"intra_1_1_1_1", SampleKind::kIntra1111},
                                    {"cross", SampleKind::kCross}};

const bool kRegistered = [] {
  for (const SolverEntry& solver : kSolvers) {
    for (const SampleEntry& sample : kSamples) {
      const std::string name = std::string("solve/") + solver.name + "/" + sample.name;
      benchmark::RegisterBenchmark(name.c_str(), solver.run, sample.kind);
    }
  }
  for (const FivePointKind& kind : kFivePointKinds) {
    const std::string name = std::string("solve/5pt-martyushev/") + kind.name;
    benchmark::RegisterBenchmark(name.c_str(), martyushev, kind)->Iterations(kProblems);
  }
  return true;
}();

BENCHMARK(realRoots)->Name("roots/degree6");
BENCHMARK(companion)->Name("yardstick/companion6");

}  // namespace
}  // namespace multicam_egomotion

BENCHMARK_MAIN();
