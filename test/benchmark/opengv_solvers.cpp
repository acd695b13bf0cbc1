// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
//
// OpenGV's solvers of the generalized relative pose beside ours, on problems of the same kind: solve/opengv-sixpt (six
// correspondences, rotations alone), solve/opengv-seventeenpt and solve/opengv-ge (17 correspondences; ge is iterative,
// started at no rotation, and returns the rotation alone). None of them uses the vertical or the axis. Counters as in
// solver_benchmark, and wrong: share of problems whose rotation is missed by more than 0.1 deg.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <memory>
#include <opengv/relative_pose/NoncentralRelativeAdapter.hpp>
#include <opengv/relative_pose/methods.hpp>
#include <string>
#include <vector>

#include "../unit/solver_samples.h"

namespace multicam_egomotion {
namespace {

constexpr int kProblems = 1024;

// Correspondences of four cameras; OpenGV's adapter refers to what it is given.
struct OpenGvProblem {
  opengv::bearingVectors_t bearings1, bearings2;
  std::vector<int> cameras1, cameras2;
  opengv::translations_t offsets;
  opengv::rotations_t rotations;
  Eigen::Matrix3d R;  // R_f2_f1, the transpose of OpenGV's
  std::unique_ptr<opengv::relative_pose::NoncentralRelativeAdapter> adapter;
};

std::unique_ptr<OpenGvProblem> makeProblem(SampleSimulator& random, int size, bool cross_camera) {
  auto problem = std::make_unique<OpenGvProblem>();
  const Eigen::Vector3d center = random.uniformVector(0.5);
  problem->offsets = {center, center + random.direction(), random.uniformVector(1), random.uniformVector(1)};
  problem->rotations.assign(4, Eigen::Matrix3d::Identity());
  problem->R = Eigen::AngleAxisd(random.uniform(0, 10 * M_PI / 180), random.direction()).toRotationMatrix();
  const Eigen::Vector3d t = random.uniform(0.3, 3) * random.direction();
  for (int i = 0; i < size; ++i) {
    const int camera1 = i % 4, camera2 = cross_camera ? (i + i / 4) % 4 : camera1;
    const Eigen::Vector3d bearing =
        Eigen::Vector3d(1, random.uniform(-0.8, 0.8), random.uniform(-0.6, 0.6)).normalized();
    const Eigen::Vector3d point = problem->offsets[camera1] + random.uniform(4, 20) * bearing;
    problem->bearings1.push_back(bearing);
    problem->bearings2.push_back((problem->R * point + t - problem->offsets[camera2]).normalized());
    problem->cameras1.push_back(camera1);
    problem->cameras2.push_back(camera2);
  }
  problem->adapter = std::make_unique<opengv::relative_pose::NoncentralRelativeAdapter>(
      problem->bearings1, problem->bearings2, problem->cameras1, problem->cameras2, problem->offsets,
      problem->rotations);
  return problem;
}

opengv::rotations_t sixPoint(OpenGvProblem& problem) { return opengv::relative_pose::sixpt(*problem.adapter); }

opengv::rotations_t seventeenPoint(OpenGvProblem& problem) {
  return {opengv::relative_pose::seventeenpt(*problem.adapter).leftCols<3>()};
}

opengv::rotations_t generalizedEigensolver(OpenGvProblem& problem) {
  problem.adapter->setR12(Eigen::Matrix3d::Identity());
  return {opengv::relative_pose::ge(*problem.adapter)};
}

using Solve = opengv::rotations_t (*)(OpenGvProblem&);

void solveAll(benchmark::State& state, Solve solve, int size, bool cross_camera) {
  SampleSimulator random(1);
  std::vector<std::unique_ptr<OpenGvProblem>> problems;
  for (int i = 0; i < kProblems; ++i) problems.push_back(makeProblem(random, size, cross_camera));
  double solutions = 0, failures = 0, wrong = 0;
  for (const auto& problem : problems) {
    const opengv::rotations_t found = solve(*problem);
    double error = M_PI;
    for (const Eigen::Matrix3d& R : found) error = std::min(error, rotationError(R.transpose(), problem->R));
    solutions += static_cast<double>(found.size());
    failures += error >= 1e-6;
    wrong += error >= 0.1 * M_PI / 180;
  }
  int i = 0;
  for (auto _ : state) {
    auto rotations = solve(*problems[i]);
    benchmark::DoNotOptimize(rotations);
    i = (i + 1) % kProblems;
  }
  state.counters["solutions"] = solutions / kProblems;
  state.counters["failures"] = failures / kProblems;
  state.counters["wrong"] = wrong / kProblems;
}

const bool kRegistered = [] {
  struct Entry {
    const char* name;
    Solve solve;
    int size;
  };
  for (const Entry& entry : {Entry{"sixpt", sixPoint, 6}, Entry{"seventeenpt", seventeenPoint, 17},
                             Entry{"ge", generalizedEigensolver, 17}}) {
    for (const bool cross_camera : {false, true}) {
      const std::string name = std::string("solve/opengv-") + entry.name + (cross_camera ? "/cross" : "/intra");
      benchmark::RegisterBenchmark(name.c_str(), solveAll, entry.solve, entry.size, cross_camera);
    }
  }
  return true;
}();

}  // namespace
}  // namespace multicam_egomotion
