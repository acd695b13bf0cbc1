// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pybind11/pybind11.h>

#include <string>

#include "multicam_egomotion/estimation/minimal_solvers.h"

namespace multicam_egomotion {

/// Names of the minimal solvers, and their types for estimate<Solver>().
constexpr const char* kSolverNames[] = {"4pt-vertical", "4pt-axis",    "4pt-lee",
                                        "4pt-liu",      "4pt-sweeney", "5pt-martyushev"};

/// visit(Solver{}) with the solver of that name; ValueError where there is none.
template <class Visit>
auto visitSolver(const std::string& name, const Visit& visit) {
  if (name == "4pt-vertical") return visit(FourPointVertical{});
  if (name == "4pt-axis") return visit(FourPointAxis{});
  if (name == "4pt-lee") return visit(FourPointLee{});
  if (name == "4pt-liu") return visit(FourPointLiu{});
  if (name == "4pt-sweeney") return visit(FourPointSweeney{});
  if (name == "5pt-martyushev") return visit(FivePointMartyushev{});
  std::string expected;
  for (const char* known : kSolverNames) expected += std::string(expected.empty() ? "" : ", ") + known;
  throw pybind11::value_error("solver: found '" + name + "', expected one of " + expected);
}

/// The prior that a solver takes; TypeError where `prior` is another.
template <class Prior>
const Prior& priorOf(const std::string& solver, const pybind11::handle& prior) {
  if (!pybind11::isinstance<Prior>(prior)) {
    const auto name = [](const pybind11::handle& type) { return std::string(pybind11::str(type.attr("__name__"))); };
    throw pybind11::type_error("prior of " + solver + ": found " + name(prior.get_type()) + ", expected " +
                               name(pybind11::type::of<Prior>()));
  }
  return prior.cast<const Prior&>();
}

}  // namespace multicam_egomotion
