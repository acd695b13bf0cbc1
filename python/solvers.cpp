// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include <pybind11/eigen.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <limits>

#include "bindings.h"
#include "ray_arguments.h"
#include "solver_table.h"

namespace multicam_egomotion {
namespace {

namespace py = pybind11;

struct Solutions {
  py::array_t<double> R, t;
  py::array_t<bool> scale_observable;
  std::string status;
};

std::string nameOf(SolverStatus status) {
  switch (status) {
    case SolverStatus::kOk:
      return "ok";
    case SolverStatus::kCentral:
      return "central";
    case SolverStatus::kAxisUndefined:
      return "axis_undefined";
    case SolverStatus::kInvalidInput:
      return "invalid_input";
  }
  return "unknown";
}

template <class Candidates>
Solutions toArrays(const Candidates& candidates) {
  const py::ssize_t count = candidates.size();
  Solutions result{py::array_t<double>({count, py::ssize_t{3}, py::ssize_t{3}}),
                   py::array_t<double>({count, py::ssize_t{3}}), py::array_t<bool>(count), nameOf(candidates.status)};
  for (py::ssize_t i = 0; i < count; ++i) {
    const RelativePose& pose = candidates[static_cast<int>(i)];
    Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(result.R.mutable_data(i)) = pose.R;
    Eigen::Map<Eigen::Vector3d>(result.t.mutable_data(i)) = pose.t;
    *result.scale_observable.mutable_data(i) = pose.scale_observable;
  }
  return result;
}

Solutions solve(const std::string& solver, const py::object& rays1, const py::object& rays2, const py::object& cameras1,
                const py::object& cameras2, const py::object& prior, bool positive_depths_only,
                const py::object& camera_centers) {
  std::vector<Eigen::Vector3d> centers;
  if (!camera_centers.is_none()) {
    const Rows<3> rows = rowsArgument<3>("camera_centers", camera_centers);
    for (Eigen::Index i = 0; i < rows.rows(); ++i) centers.push_back(rows.row(i));
  }
  SolverOptions options;
  options.positive_depths_only = positive_depths_only;
  options.camera_centers = centers.empty() ? nullptr : centers.data();
  options.camera_count = static_cast<int>(centers.size());
  return visitSolver(solver, [&](auto type) {
    using Solver = decltype(type);
    const int cameras = centers.empty() ? std::numeric_limits<int>::max() : static_cast<int>(centers.size());
    const auto rays = raysArgument(rays1, rays2, cameras1, cameras2, cameras, Solver::kSampleSize);
    std::array<RayCorrespondence, Solver::kSampleSize> sample;
    std::copy(rays.begin(), rays.end(), sample.begin());
    return toArrays(Solver::solve(sample, priorOf<typename Solver::Prior>(solver, prior), options));
  });
}

}  // namespace

void bindSolvers(py::module_& module) {
  py::class_<VerticalPrior>(module, "VerticalPrior", "The vertical direction in both body frames.")
      .def(py::init([](const py::object& up1, const py::object& up2) {
             const Eigen::Vector3d first = vectorArgument("up1", up1), second = vectorArgument("up2", up2);
             if (!(first.norm() > 0.0)) throw py::value_error("up1: found no direction, expected one that is not zero");
             if (!(second.norm() > 0.0))
               throw py::value_error("up2: found no direction, expected one that is not zero");
             return verticalPriorFromUp(first, second);
           }),
           py::arg("up1"), py::arg("up2"),
           "up1, up2 (3,): up (minus gravity) in the body at t1 and at t2, of any length.");
  py::class_<AxisPrior>(module, "AxisPrior", "The rotation axis of R.")
      .def(py::init([](const py::object& axis) { return AxisPrior{vectorArgument("axis", axis)}; }), py::arg("axis"),
           "axis (3,): the same vector in the body at t1 and at t2; length and sign do not matter.");

  py::class_<AnglePrior>(module, "AnglePrior", "The rotation angle of R.")
      .def(py::init([](double angle) { return AnglePrior{angle}; }), py::arg("angle"), "angle [rad], of any sign.");

  py::class_<Solutions>(module, "Solutions", "All real solutions of a minimal sample.")
      .def_readonly("R", &Solutions::R, "(k, 3, 3), R_f2_f1")
      .def_readonly("t", &Solutions::t, "(k, 3) [m]")
      .def_readonly("scale_observable", &Solutions::scale_observable, "(k,), False: only the direction of t is meant")
      .def_readonly("status", &Solutions::status, "ok, central, axis_undefined or invalid_input")
      .def("__len__", [](const Solutions& solutions) { return solutions.t.shape(0); });

  py::tuple names(std::size(kSolverNames));
  for (std::size_t i = 0; i < std::size(kSolverNames); ++i) names[i] = kSolverNames[i];
  module.attr("SOLVERS") = names;
  module.def("solve", &solve, py::arg("solver"), py::arg("rays1"), py::arg("rays2"), py::arg("cameras1"),
             py::arg("cameras2"), py::arg("prior"), py::arg("positive_depths_only") = false,
             py::arg("camera_centers") = py::none(),
             R"(Solutions of one minimal sample.

solver: one of SOLVERS. 4pt-vertical, 4pt-lee and 4pt-liu take a VerticalPrior, 4pt-axis and 4pt-sweeney an AxisPrior,
5pt-martyushev an AnglePrior.
rays1, rays2 (4, 6): Pluecker lines in the body at t1 and at t2; (5, 6) for 5pt-martyushev. cameras1, cameras2 (4,) or
(5,): camera indices.
positive_depths_only: drop poses that put a point behind one of its rays; camera_centers (cameras, 3) [m] makes that exact.
A sample that determines no pose is no error: it has a status and no solutions.)");
}

}  // namespace multicam_egomotion
