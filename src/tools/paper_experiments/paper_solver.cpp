// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "paper_experiments/paper_solver.h"

#include <algorithm>
#include <chrono>

#include "multicam_egomotion/estimation/minimal_solvers.h"

namespace multicam_egomotion {
namespace {

template <class Prior>
struct PriorOf;

template <>
struct PriorOf<VerticalPrior> {
  static constexpr PriorKind kKind = PriorKind::kVertical;
  static VerticalPrior take(const SolverPriors& priors) { return priors.vertical; }
};

template <>
struct PriorOf<AxisPrior> {
  static constexpr PriorKind kKind = PriorKind::kAxis;
  static AxisPrior take(const SolverPriors& priors) { return priors.axis; }
};

template <>
struct PriorOf<AnglePrior> {
  static constexpr PriorKind kKind = PriorKind::kAngle;
  static AnglePrior take(const SolverPriors& priors) { return {priors.angle}; }
};

template <class Solver>
std::array<RayCorrespondence, Solver::kSampleSize> firstRays(const RayCorrespondence* rays) {
  std::array<RayCorrespondence, Solver::kSampleSize> sample;
  std::copy(rays, rays + Solver::kSampleSize, sample.begin());
  return sample;
}

template <class Solver>
SolverStatus solve(const RayCorrespondence* sample, const SolverPriors& priors, const SolverOptions& options,
                   std::vector<RelativePose>* solutions) {
  const auto found = Solver::solve(firstRays<Solver>(sample), PriorOf<typename Solver::Prior>::take(priors), options);
  solutions->assign(found.begin(), found.end());
  return found.status;
}

template <class Solver>
double time(const SolverProblem* problems, int count) {
  std::vector<std::array<RayCorrespondence, Solver::kSampleSize>> samples(count);
  std::vector<typename Solver::Prior> priors(count);
  for (int i = 0; i < count; ++i) {
    samples[i] = firstRays<Solver>(problems[i].rays.data());
    priors[i] = PriorOf<typename Solver::Prior>::take(problems[i].priors);
  }
  volatile int solutions = 0;  // that the compiler may not leave out
  const auto start = std::chrono::steady_clock::now();
  for (int i = 0; i < count; ++i) solutions = solutions + Solver::solve(samples[i], priors[i], {}).count;
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

template <class Solver>
PaperSolver solver(const std::string& name) {
  return {name, PriorOf<typename Solver::Prior>::kKind, Solver::kSampleSize, &solve<Solver>, &time<Solver>};
}

}  // namespace

const std::vector<PaperSolver>& paperSolvers() {
  static const std::vector<PaperSolver> solvers = {
      solver<FivePointMartyushev>("5pt-martyushev"),
      solver<FourPointLee>("4pt-lee"),
      solver<FourPointLiu>("4pt-liu"),
      solver<FourPointSweeney>("4pt-sweeney"),
      solver<FourPointVertical>("4pt-vertical"),
      solver<FourPointAxis>("4pt-axis"),
  };
  return solvers;
}

}  // namespace multicam_egomotion
