// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "multicam_egomotion/odometry/calibrated_rig.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "multicam_egomotion/geometry/so3.h"

namespace multicam_egomotion {
namespace {

constexpr double kSmallestSigma = 0.005 * M_PI / 180.0;  // [rad]
constexpr double kFaultSigmas = 4.0;                     // of what the rig file may be wrong by, contract 15

double degrees(double radians) { return radians * 180.0 / M_PI; }

template <typename... Values>
std::string text(const char* format, Values... values) {
  char line[200];
  std::snprintf(line, sizeof(line), format, values...);
  return line;
}

}  // namespace

CameraRig calibratedRig(const CameraRig& rig, const std::vector<CameraCalibration>& calibration) {
  std::vector<RigCamera> cameras = rig.cameras();
  for (const CameraCalibration& one : calibration) {
    RigCamera& camera = cameras.at(one.camera);
    const Eigen::Matrix3d R_body_cam = camera.T_body_cam.linear() * expSO3(one.rotation);
    camera.T_body_cam.linear() = Eigen::Quaterniond(R_body_cam).normalized().toRotationMatrix();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(one.covariance, Eigen::EigenvaluesOnly);
    camera.sigmas.rotation = std::max(kSmallestSigma, std::sqrt(std::max(0.0, eigen.eigenvalues().maxCoeff())));
  }
  return CameraRig(std::move(cameras));
}

std::vector<std::string> calibrationFaults(const CameraRig& rig, const std::vector<CameraCalibration>& calibration) {
  std::vector<std::string> faults;
  for (const CameraCalibration& one : calibration) {
    const RigCamera &camera = rig.camera(one.camera), &first = rig.camera(0);
    const Eigen::Vector3d turn = one.rotation.unaryExpr([](double angle) { return degrees(angle); });
    // A shifted principal point looks like a turn.
    const double sigma =
        std::hypot(camera.sigmas.rotation, camera.sigmas.principal_point_px / camera.model.focalLength());
    if (one.rotation.cwiseAbs().maxCoeff() > kFaultSigmas * sigma) {
      faults.push_back(camera.name + text(" is turned by %.2f deg (%.2f %.2f %.2f about its x y z) against the rig "
                                          "file, expected at most %.2f deg: check T_body_cam and the mounting",
                                          turn.norm(), turn.x(), turn.y(), turn.z(), degrees(kFaultSigmas * sigma)));
    }
    if (!one.overlaps) continue;
    const double focal_length = std::hypot(camera.sigmas.focal_length, first.sigmas.focal_length);
    if (std::abs(one.focal_length) > kFaultSigmas * focal_length) {
      faults.push_back(camera.name + text(" has a focal length %.1f %% off that of the rig file, expected at most %.1f "
                                          "%%: check its intrinsics and those of %s",
                                          100.0 * one.focal_length, 100.0 * kFaultSigmas * focal_length,
                                          first.name.c_str()));
    }
    const double distortion = std::hypot(camera.sigmas.distortion_px, first.sigmas.distortion_px);
    if (one.static_error_px > kFaultSigmas * distortion) {
      faults.push_back(camera.name + text(" has matches %.1f px off their epipolar lines, expected at most %.1f px: "
                                          "check intrinsics and distortion",
                                          one.static_error_px, kFaultSigmas * distortion));
    }
  }
  return faults;
}

}  // namespace multicam_egomotion
