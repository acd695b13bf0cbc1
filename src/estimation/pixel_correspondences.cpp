// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "multicam_egomotion/estimation/pixel_correspondences.h"

#include <cmath>
#include <stdexcept>
#include <string>

namespace multicam_egomotion {
namespace {

void checkCamera(const char* name, int camera, int cameras) {
  if (camera >= 0 && camera < cameras) return;
  throw std::invalid_argument(std::string("pixel correspondence: ") + name + " is " + std::to_string(camera) +
                              ", expected 0 to " + std::to_string(cameras - 1));
}

bool rayOfPixel(const RigCamera& camera, const Eigen::Vector2d& pixel, Ray* ray, double* pixels_per_radian) {
  Eigen::Vector3d bearing;
  Eigen::Vector2d back;
  Eigen::Matrix<double, 2, 3> d_pixel_d_bearing;
  if (!camera.model.unproject(pixel, &bearing) || !camera.model.project(bearing, &back, &d_pixel_d_bearing)) {
    return false;
  }
  *ray = makeRay(camera.T_body_cam.linear() * bearing, camera.T_body_cam.translation());
  *pixels_per_radian = d_pixel_d_bearing.norm() / std::sqrt(2.0);  // mean square over the directions in the image
  return true;
}

}  // namespace

bool entryFromPixels(const CameraRig& rig, const PixelCorrespondence& pixels, CorrespondenceSet::Entry* entry) {
  checkCamera("camera1", pixels.camera1, rig.size());
  checkCamera("camera2", pixels.camera2, rig.size());
  entry->rays.camera1 = pixels.camera1;
  entry->rays.camera2 = pixels.camera2;
  entry->quality = pixels.quality;
  return rayOfPixel(rig.camera(pixels.camera1), pixels.pixel1, &entry->rays.first, &entry->pixels_per_radian1) &&
         rayOfPixel(rig.camera(pixels.camera2), pixels.pixel2, &entry->rays.second, &entry->pixels_per_radian2);
}

PixelCorrespondenceSet correspondencesFromPixels(const CameraRig& rig, const std::vector<PixelCorrespondence>& pixels) {
  std::vector<CorrespondenceSet::Entry> entries;
  std::vector<int> indices;
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    CorrespondenceSet::Entry entry;
    if (!entryFromPixels(rig, pixels[i], &entry)) continue;
    entries.push_back(entry);
    indices.push_back(static_cast<int>(i));
  }
  std::vector<Eigen::Vector3d> centers;
  for (const RigCamera& camera : rig.cameras()) centers.push_back(camera.T_body_cam.translation());
  return {CorrespondenceSet(entries, centers, centers), indices};
}

}  // namespace multicam_egomotion
