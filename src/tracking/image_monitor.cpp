// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "multicam_egomotion/tracking/image_monitor.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>

namespace multicam_egomotion {
namespace {

constexpr int kRowStep = 8;            // every so many rows are looked at,
constexpr int kColumnStep = 8;         // and for the grey levels as many columns
constexpr double kRemembered = 1.0;    // time over which rotation adds up while the picture stays the same [s]
constexpr int kImagesUntilFrozen = 3;  // of one picture, where only another camera tells that it should have changed

// FNV-1a over words of 8 bytes; sensor noise alone makes any two pictures differ.
std::uint64_t hashOf(const cv::Mat& grey) {
  std::uint64_t hash = 14695981039346656037ull;
  for (int y = kRowStep / 2; y < grey.rows; y += kRowStep) {
    const unsigned char* row = grey.ptr(y);
    for (int x = 0; x + 8 <= grey.cols; x += 8) {
      std::uint64_t word;
      std::memcpy(&word, row + x, sizeof(word));
      hash = (hash ^ word) * 1099511628211ull;
    }
  }
  return hash;
}

struct GreyLevels {
  double mean, deviation, saturated_share;
};

GreyLevels greyLevels(const cv::Mat& grey, int saturated_level) {
  double n = 0.0, sum = 0.0, squares = 0.0, saturated = 0.0;
  for (int y = std::min(kRowStep / 2, grey.rows - 1); y < grey.rows; y += kRowStep) {
    const unsigned char* row = grey.ptr(y);
    for (int x = std::min(kColumnStep / 2, grey.cols - 1); x < grey.cols; x += kColumnStep) {
      const double level = row[x];
      n += 1.0;
      sum += level;
      squares += level * level;
      saturated += row[x] >= saturated_level;
    }
  }
  const double mean = sum / n;
  return {mean, std::sqrt(std::max(0.0, squares / n - mean * mean)), saturated / n};
}

std::string text(const cv::Size& size) { return std::to_string(size.width) + "x" + std::to_string(size.height); }

}  // namespace

ImageMonitor::ImageMonitor(const CameraRig& rig, const ImageMonitorOptions& options) : options_(options) {
  for (int i = 0; i < rig.size(); ++i) {
    const RigCamera& of_rig = rig.camera(i);
    Camera camera;
    camera.name = of_rig.name.empty() ? "cam" + std::to_string(i) : of_rig.name;
    camera.size = camera.found_size = cv::Size(of_rig.model.width(), of_rig.model.height());
    cameras_.push_back(camera);
  }
}

void ImageMonitor::reset() {
  for (Camera& camera : cameras_) {
    Camera anew;
    anew.name = camera.name;
    anew.size = camera.size;
    anew.found_size = camera.found_size;
    camera = anew;
  }
}

bool ImageMonitor::fits(const CameraImage& image) {
  if (image.camera < 0 || image.camera >= static_cast<int>(cameras_.size()) || image.grey.empty()) return true;
  Camera& camera = cameras_[image.camera];
  camera.found_size = image.grey.size();
  if (camera.found_size == camera.size) return true;
  ++wrong_sizes_;
  return false;
}

void ImageMonitor::look(const CameraImage& image, Camera* camera) const {
  const GreyLevels levels = greyLevels(image.grey, options_.saturated_level);
  const bool saturated = levels.saturated_share >= options_.saturated_share;
  const bool dark = levels.mean < options_.dark_mean;
  const bool flat = levels.deviation < options_.least_contrast;
  camera->dark = dark ? camera->dark + 1 : 0;
  camera->saturated = saturated ? camera->saturated + 1 : 0;
  camera->flat = flat ? camera->flat + 1 : 0;

  const std::uint64_t hash = hashOf(image.grey);
  // Pictures that show nothing may well be alike.
  const bool same = camera->images_of_picture > 0 && hash == camera->hash && !flat;
  camera->hash = hash;
  camera->picture_newest_ns = image.stamp_ns;
  if (same) {
    ++camera->images_of_picture;
    return;
  }
  camera->images_of_picture = 1;
  camera->picture_since_ns = image.stamp_ns;
  camera->rotation.setZero();
  camera->rotation_sigma = 0.0;
  camera->frozen = false;
}

bool ImageMonitor::hasMoved(const Camera& camera, const ExpectedMotion& motion) const {
  const double sigma = camera.rotation_sigma + motion.rotation_sigma;
  return motion.translation || (camera.rotation + motion.rotation).norm() > options_.moving_rotation + 3.0 * sigma;
}

void ImageMonitor::takeOutFrozen(const ExpectedMotion& motion, FrameSet* set) {
  bool change = false;
  for (const CameraImage& image : set->images) {
    Camera& camera = cameras_[image.camera];
    look(image, &camera);
    change = change || (camera.images_of_picture == 1 && camera.flat == 0);
  }
  for (const CameraImage& image : set->images) {
    Camera& camera = cameras_[image.camera];
    if (camera.images_of_picture < 2) continue;
    camera.frozen =
        camera.frozen || hasMoved(camera, motion) || (change && camera.images_of_picture >= kImagesUntilFrozen);
  }
  set->images.erase(std::remove_if(set->images.begin(), set->images.end(),
                                   [this](const CameraImage& image) { return cameras_[image.camera].frozen; }),
                    set->images.end());
  if (set->images.empty()) return;
  const double keep = std::exp(-motion.duration_s / kRemembered);
  for (Camera& camera : cameras_) {
    if (camera.images_of_picture < 2) continue;
    camera.rotation = keep * (camera.rotation + motion.rotation);
    camera.rotation_sigma = keep * (camera.rotation_sigma + motion.rotation_sigma);
  }
}

std::vector<std::string> ImageMonitor::faults() const {
  std::vector<std::string> faults;
  for (const Camera& camera : cameras_) {
    const auto add = [&](const std::string& what) { faults.push_back(camera.name + ": " + what); };
    if (camera.found_size != camera.size) {
      add("image is " + text(camera.found_size) + ", expected " + text(camera.size));
    }
    if (camera.saturated >= options_.images_until_named) {
      add("saturated");
    } else if (camera.dark >= options_.images_until_named) {
      add("dark");
    } else if (camera.flat >= options_.images_until_named) {
      add("no contrast");
    }
    const double same_s = 1e-9 * static_cast<double>(camera.picture_newest_ns - camera.picture_since_ns);
    if (camera.images_of_picture >= kImagesUntilFrozen && (camera.frozen || same_s >= options_.frozen_s)) {
      char since[32];
      std::snprintf(since, sizeof(since), "%.1f", same_s);
      add(std::string("same picture since ") + since + " s, frozen?");
    }
  }
  return faults;
}

}  // namespace multicam_egomotion
