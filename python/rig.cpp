// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include <pybind11/eigen.h>
#include <pybind11/stl.h>

#include <limits>

#include "array_arguments.h"
#include "bindings.h"
#include "multicam_egomotion/geometry/camera_rig.h"
#include "multicam_egomotion/geometry/ray.h"
#include "multicam_egomotion/geometry/rigid_transform.h"

namespace multicam_egomotion {
namespace {

namespace py = pybind11;

RigCamera makeCamera(int width, int height, double fx, double fy, double cx, double cy, const py::object& T_body_cam,
                     const std::string& distortion, const std::vector<double>& coefficients, const std::string& name) {
  const CameraModel model(width, height, fx, fy, cx, cy, distortionFromName(distortion), coefficients);
  const Eigen::Matrix4d matrix = rowsArgument<4>("T_body_cam", T_body_cam, 4);
  try {
    return {name, name, model, rigidTransform(matrix), 0.0};
  } catch (const std::invalid_argument& error) {
    throw py::value_error(std::string("T_body_cam ") + error.what());
  }
}

Rows<6> raysFromBearings(const py::object& directions, const py::object& centers) {
  const Rows<3> x = rowsArgument<3>("directions", directions), c = rowsArgument<3>("centers", centers, x.rows());
  Rows<6> rays(x.rows(), 6);
  for (Eigen::Index i = 0; i < x.rows(); ++i) {
    const Ray ray = makeRay(x.row(i).normalized().transpose(), c.row(i).transpose());
    rays.row(i) << ray.direction.transpose(), ray.moment.transpose();
  }
  return rays;
}

Rows<6> raysFromPixels(const CameraRig& rig, const py::object& cameras, const py::object& pixels) {
  const Rows<2> pixel = rowsArgument<2>("pixels", pixels);
  const std::vector<int> camera = camerasArgument("cameras", cameras, pixel.rows(), rig.size());
  Rows<6> rays = Rows<6>::Constant(pixel.rows(), 6, std::numeric_limits<double>::quiet_NaN());
  for (Eigen::Index i = 0; i < pixel.rows(); ++i) {
    const RigCamera& one = rig.camera(camera[i]);
    Eigen::Vector3d bearing;
    if (!one.model.unproject(pixel.row(i).transpose(), &bearing)) continue;
    const Ray ray = makeRay(one.T_body_cam.linear() * bearing, one.T_body_cam.translation());
    rays.row(i) << ray.direction.transpose(), ray.moment.transpose();
  }
  return rays;
}

Rows<3> centersOf(const CameraRig& rig) {
  Rows<3> centers(rig.size(), 3);
  for (int i = 0; i < rig.size(); ++i) centers.row(i) = rig.camera(i).T_body_cam.translation();
  return centers;
}

}  // namespace

void bindRig(py::module_& module) {
  py::class_<RigCamera>(module, "Camera", "One calibrated camera, mounted on the body.")
      .def(py::init(&makeCamera), py::arg("width"), py::arg("height"), py::arg("fx"), py::arg("fy"), py::arg("cx"),
           py::arg("cy"), py::arg("T_body_cam"), py::arg("distortion") = "none",
           py::arg("coefficients") = std::vector<double>(), py::arg("name") = "camera",
           R"(width, height, fx, fy, cx, cy [px]; pixel (0, 0) is the centre of the upper left one.
T_body_cam (4, 4): pose of the optical frame (x right, y down, z forward) in the body [m].
distortion: none, radtan (plumb_bob: k1 k2 p1 p2 [k3]), rational_polynomial (k1 k2 p1 p2 k3 k4 k5 k6) or
equidistant (fisheye: k1 k2 k3 k4), with its coefficients.)");

  py::class_<CameraRig>(module, "CameraRig", "One to eight cameras on one body.")
      .def(py::init<std::vector<RigCamera>>(), py::arg("cameras"))
      .def("__len__", &CameraRig::size)
      .def_property_readonly("centers", &centersOf, "Camera centres in the body frame, (cameras, 3) [m].");

  module.def("rays_from_bearings", &raysFromBearings, py::arg("directions"), py::arg("centers"),
             "Rays (n, 6) from directions (n, 3) in body axes, of any length, and camera centres (n, 3) [m].");
  module.def("rays_from_pixels", &raysFromPixels, py::arg("rig"), py::arg("cameras"), py::arg("pixels"),
             "Rays (n, 6) from camera indices (n,) and pixels (n, 2); NaN where the calibration has no ray.");
}

}  // namespace multicam_egomotion
