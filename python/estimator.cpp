// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include <pybind11/eigen.h>
#include <pybind11/stl.h>

#include <cmath>

#include "bindings.h"
#include "multicam_egomotion/estimation/pixel_correspondences.h"
#include "multicam_egomotion/estimation/robust_estimator.h"
#include "ray_arguments.h"
#include "solver_table.h"

namespace multicam_egomotion {
namespace {

namespace py = pybind11;

// `indices`: which of the `size` correspondences of the caller those of the set are; the others are no inliers.
RobustEstimate estimateSet(const std::string& solver, const CorrespondenceSet& set, const std::vector<int>& indices,
                           std::size_t size, const py::object& prior, const MotionPriors& priors,
                           const RobustEstimatorOptions& options, std::uint64_t seed) {
  RobustEstimate result = visitSolver(solver, [&](auto type) {
    using Solver = decltype(type);
    const auto& known = priorOf<typename Solver::Prior>(solver, prior);
    const py::gil_scoped_release release;
    return estimate<Solver>(set, known, priors, options, seed);
  });
  std::vector<char> inliers(size, 0);
  for (std::size_t i = 0; i < indices.size(); ++i) inliers[indices[i]] = result.inliers[i];
  result.inliers = inliers;
  return result;
}

RobustEstimate estimateFromRays(const std::string& solver, const py::object& rays1, const py::object& rays2,
                                const py::object& cameras1, const py::object& cameras2,
                                const py::object& camera_centers, const py::object& prior,
                                const py::object& pixels_per_radian, const py::object& quality,
                                const MotionPriors& priors, const RobustEstimatorOptions& options, std::uint64_t seed) {
  const Rows<3> rows = rowsArgument<3>("camera_centers", camera_centers);
  std::vector<Eigen::Vector3d> centers;
  for (Eigen::Index i = 0; i < rows.rows(); ++i) centers.push_back(rows.row(i));
  const auto rays = raysArgument(rays1, rays2, cameras1, cameras2, static_cast<int>(centers.size()));
  const auto size = static_cast<py::ssize_t>(rays.size());
  const std::vector<double> scales = valuesArgument("pixels_per_radian", pixels_per_radian, size);
  const std::vector<double> qualities = valuesArgument("quality", quality, size);
  std::vector<CorrespondenceSet::Entry> entries;
  std::vector<int> indices;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (!(scales[i] > 0.0)) {
      throw py::value_error("pixels_per_radian: found " + std::to_string(scales[i]) + ", expected a positive number");
    }
    const Ray &first = rays[i].first, &second = rays[i].second;
    if (!first.direction.allFinite() || !second.direction.allFinite()) continue;
    entries.push_back({rays[i], scales[i], scales[i], qualities[i]});
    indices.push_back(static_cast<int>(i));
  }
  const CorrespondenceSet set(entries, centers, centers);
  return estimateSet(solver, set, indices, rays.size(), prior, priors, options, seed);
}

RobustEstimate estimateFromPixels(const std::string& solver, const CameraRig& rig, const py::object& cameras1,
                                  const py::object& pixels1, const py::object& cameras2, const py::object& pixels2,
                                  const py::object& prior, const py::object& quality, const MotionPriors& priors,
                                  const RobustEstimatorOptions& options, std::uint64_t seed) {
  const Rows<2> first = rowsArgument<2>("pixels1", pixels1), second = rowsArgument<2>("pixels2", pixels2, first.rows());
  const std::vector<int> c1 = camerasArgument("cameras1", cameras1, first.rows(), rig.size());
  const std::vector<int> c2 = camerasArgument("cameras2", cameras2, first.rows(), rig.size());
  const std::vector<double> qualities = valuesArgument("quality", quality, first.rows());
  std::vector<PixelCorrespondence> pixels;
  for (Eigen::Index i = 0; i < first.rows(); ++i) {
    pixels.push_back({c1[i], first.row(i).transpose(), c2[i], second.row(i).transpose(), qualities[i]});
  }
  const PixelCorrespondenceSet all = correspondencesFromPixels(rig, pixels);
  return estimateSet(solver, all.set, all.indices, pixels.size(), prior, priors, options, seed);
}

double informationOf(const char* name, double sigma) {
  if (sigma > 0.0 && std::isfinite(sigma)) return 1.0 / (sigma * sigma);
  throw py::value_error(std::string(name) + ": found " + std::to_string(sigma) +
                        ", expected a positive number of radians");
}

MotionPriors makePriors(const py::object& R, const py::object& R_sigma, const py::object& up1, const py::object& up2,
                        const py::object& tilt_sigma, const py::object& angle, const py::object& angle_sigma) {
  const auto all_or_none = [](const char* names, std::initializer_list<py::object> objects) {
    std::size_t given = 0;
    for (const py::object& object : objects) given += !object.is_none();
    if (given != 0 && given != objects.size()) {
      throw py::value_error(std::string(names) + ": found only some of them, expected all or none");
    }
    return given > 0;
  };
  MotionPriors priors;
  if (all_or_none("R, R_sigma", {R, R_sigma})) {
    priors.rotation.R = matrixArgument("R", R);
    if (!((priors.rotation.R.transpose() * priors.rotation.R).isIdentity(1e-6) &&
          priors.rotation.R.determinant() > 0)) {
      throw py::value_error("R: found a matrix that is not a rotation, expected one");
    }
    priors.rotation.information = informationOf("R_sigma", R_sigma.cast<double>()) * Eigen::Matrix3d::Identity();
  }
  if (all_or_none("up1, up2, tilt_sigma", {up1, up2, tilt_sigma})) {
    priors.tilt.up_body1 = vectorArgument("up1", up1).normalized();
    priors.tilt.up_body2 = vectorArgument("up2", up2).normalized();
    priors.tilt.information = informationOf("tilt_sigma", tilt_sigma.cast<double>());
  }
  if (all_or_none("angle, angle_sigma", {angle, angle_sigma})) {
    priors.angle.angle = angle.cast<double>();
    priors.angle.information = informationOf("angle_sigma", angle_sigma.cast<double>());
  }
  return priors;
}

// Options(name=value, ...)
RobustEstimatorOptions makeOptions(const py::kwargs& values) {
  RobustEstimatorOptions options;
  const py::object object = py::cast(&options, py::return_value_policy::reference);
  for (const auto& [name, value] : values) {
    if (!py::hasattr(object, name)) {
      throw py::type_error("Options: found '" + std::string(py::str(name)) + "', expected one of its attributes");
    }
    py::setattr(object, name, value);
  }
  return options;
}

std::string nameOf(ScaleState state) {
  switch (state) {
    case ScaleState::kNotApplicable:
      return "not_applicable";
    case ScaleState::kObservable:
      return "observable";
    case ScaleState::kWeak:
      return "weak";
    case ScaleState::kUnobservable:
      return "unobservable";
  }
  return "unknown";
}

void bindOptions(py::module_& module) {
  using Options = RobustEstimatorOptions;
  py::enum_<Sampling>(module, "Sampling")
      .value("UNIFORM", Sampling::kUniform)
      .value("PROSAC", Sampling::kProsac)
      .value("RIG_AWARE", Sampling::kRigAware);
  py::enum_<Score>(module, "Score").value("MSAC", Score::kMsac).value("MARGINALIZING", Score::kMarginalizing);
  py::class_<Options>(module, "Options", "Options of the robust estimator: Options(max_samples=1000, ...).")
      .def(py::init(&makeOptions))
      .def_readwrite("max_epipolar_error_px", &Options::max_epipolar_error_px, "Sampson error of an inlier [px]")
      .def_readwrite("success_probability", &Options::success_probability)
      .def_readwrite("max_samples", &Options::max_samples)
      .def_readwrite("min_samples", &Options::min_samples)
      .def_readwrite("min_inliers", &Options::min_inliers)
      .def_readwrite("max_rotation_sigmas", &Options::max_rotation_sigmas,
                     "hypotheses further from the rotation prior are dropped unscored")
      .def_readwrite("sampling", &Options::sampling)
      .def_readwrite("score", &Options::score)
      .def_readwrite("local_optimization", &Options::local_optimization)
      .def_readwrite("final_refinement", &Options::final_refinement, "without it there is no covariance");
  py::class_<MotionPriors>(module, "MotionPriors", "What is known of the rotation besides the images.")
      .def(py::init(&makePriors), py::arg("R") = py::none(), py::arg("R_sigma") = py::none(),
           py::arg("up1") = py::none(), py::arg("up2") = py::none(), py::arg("tilt_sigma") = py::none(),
           py::arg("angle") = py::none(), py::arg("angle_sigma") = py::none(),
           R"(All enter the refinement; each group is given whole or not at all.
R (3, 3), R_sigma [rad]: rotation R_f2_f1, from a gyroscope say; hypotheses far from it are dropped too.
up1, up2 (3,), tilt_sigma [rad]: R turns up1 into up2, up to that angle about each horizontal axis.
angle, angle_sigma [rad]: angle of R, in [0, pi].)");
}

void bindResult(py::module_& module) {
  using Result = RobustEstimate;
  py::class_<Result>(module, "RobustEstimate")
      .def_readonly("success", &Result::success)
      .def_readonly("R", &Result::R, "(3, 3), R_f2_f1")
      .def_readonly("t", &Result::t, "(3,) [m]; its length means nothing where scale_state is unobservable")
      .def_property_readonly(
          "inliers",
          [](const Result& result) {
            py::array_t<bool> mask(static_cast<py::ssize_t>(result.inliers.size()));
            std::copy(result.inliers.begin(), result.inliers.end(), mask.mutable_data());
            return mask;
          },
          "(n,) bool, in the order of the correspondences")
      .def_readonly("inlier_count", &Result::inlier_count)
      .def_readonly("score", &Result::score, "sum of losses between 0 and 1 of the best model before the refinement")
      .def_readonly("covariance", &Result::covariance,
                    "(6, 6), order (t [m], theta [rad]): t_true = t + dt, R_true = Exp(dtheta) R")
      .def_readonly("pixel_sigma", &Result::pixel_sigma, "image noise that the inliers show [px]")
      .def_property_readonly(
          "scale_sigma", [](const Result& result) { return result.scale.sigma; },
          "standard deviation of the length of t, as a share of it")
      .def_property_readonly(
          "scale_state", [](const Result& result) { return nameOf(result.scale.state); },
          "observable (sigma < 0.1), weak (< 0.5), unobservable, or not_applicable (no motion)")
      .def_readonly("samples", &Result::samples)
      .def_readonly("models", &Result::models)
      .def_readonly("refinements", &Result::refinements)
      .def("__repr__", [](const Result& result) {
        return "RobustEstimate(success=" + std::string(result.success ? "True" : "False") +
               ", inliers=" + std::to_string(result.inlier_count) + " of " + std::to_string(result.inliers.size()) +
               ", scale " + nameOf(result.scale.state) + ")";
      });
}

}  // namespace

void bindEstimator(py::module_& module) {
  bindOptions(module);
  bindResult(module);
  module.def("estimate", &estimateFromRays, py::arg("solver"), py::arg("rays1"), py::arg("rays2"), py::arg("cameras1"),
             py::arg("cameras2"), py::arg("camera_centers"), py::arg("prior"), py::kw_only(),
             py::arg("pixels_per_radian"), py::arg("quality") = 0.0, py::arg("priors") = MotionPriors(),
             py::arg("options") = RobustEstimatorOptions(), py::arg("seed") = 1,
             R"(Relative pose of n ray correspondences with outliers, and its covariance; a RobustEstimate.

solver: one of SOLVERS, prior as for solve(). rays1, rays2 (n, 6), cameras1, cameras2 (n,) or one index.
camera_centers (cameras, 3) [m]. pixels_per_radian (n,) or one number: image scale, about the focal length [px].
quality (n,): for Sampling.PROSAC, the better the higher. Rays that are NaN are no inliers. Deterministic by seed. What the solver is told by `prior` holds
for the hypotheses; only `priors` (MotionPriors) enter the refinement.)");
  module.def("estimate_from_pixels", &estimateFromPixels, py::arg("solver"), py::arg("rig"), py::arg("cameras1"),
             py::arg("pixels1"), py::arg("cameras2"), py::arg("pixels2"), py::arg("prior"), py::kw_only(),
             py::arg("quality") = 0.0, py::arg("priors") = MotionPriors(),
             py::arg("options") = RobustEstimatorOptions(), py::arg("seed") = 1,
             R"(The same from pixels1, pixels2 (n, 2) of the cameras of a CameraRig.

Pixels whose camera has no ray for them are no inliers.)");
}

}  // namespace multicam_egomotion
