// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "simulator/renderer.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <functional>
#include <thread>

#include "simulator/random.h"

namespace multicam_egomotion {

namespace {

constexpr int kSupersamples = 4;  // a side, on edges

// Runs work(0) ... work(count - 1) on `threads` threads; each item writes only its own part.
void parallelFor(int count, int threads, const std::function<void(int)>& work) {
  std::atomic<int> next{0};
  const auto run = [&] {
    for (int i = next++; i < count; i = next++) work(i);
  };
  std::vector<std::thread> pool;
  for (int i = 1; i < threads; ++i) pool.emplace_back(run);
  run();
  for (std::thread& thread : pool) thread.join();
}

}  // namespace

struct Renderer::Shot {
  Eigen::Vector3d origin;
  Eigen::Matrix3d R_world_cam;
  std::vector<SceneHit> hits;
  std::vector<std::vector<int>> candidates;  // boxes in each tile
  cv::Mat image;
};

Renderer::Renderer(const CameraModel& model)
    : width_(model.width()),
      height_(model.height()),
      tiles_x_((width_ + kTile - 1) / kTile),
      tiles_y_((height_ + kTile - 1) / kTile),
      rays_(static_cast<std::size_t>(width_) * height_),
      tiles_(static_cast<std::size_t>(tiles_x_) * tiles_y_) {
  for (int y = 0; y < height_; ++y) {
    for (int x = 0; x < width_; ++x) {
      PixelRay& ray = rays_[y * width_ + x];
      Eigen::Vector3d bearing;
      Eigen::Matrix<double, 3, 2> d_bearing;
      if (model.unproject(Eigen::Vector2d(x, y), &bearing, &d_bearing)) {
        ray = {bearing.cast<float>(), d_bearing.col(0).cast<float>(), d_bearing.col(1).cast<float>()};
      } else {
        ray = {Eigen::Vector3f::Zero(), Eigen::Vector3f::Zero(), Eigen::Vector3f::Zero()};
      }
    }
  }
  for (int t = 0; t < tiles_x_ * tiles_y_; ++t) {
    const int x0 = t % tiles_x_ * kTile, y0 = t / tiles_x_ * kTile;
    const int x1 = std::min(width_, x0 + kTile), y1 = std::min(height_, y0 + kTile);
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (int y = y0; y < y1; ++y) {
      for (int x = x0; x < x1; ++x) sum += rays_[y * width_ + x].bearing.cast<double>();
    }
    Tile& tile = tiles_[t];
    tile.axis = sum.norm() > 0.0 ? Eigen::Vector3d(sum.normalized()) : Eigen::Vector3d::UnitZ();
    tile.half_angle = 0.0;
    for (int y = y0; y < y1; ++y) {
      for (int x = x0; x < x1; ++x) {
        const PixelRay& ray = rays_[y * width_ + x];
        if (ray.bearing.isZero()) continue;
        const double cosine = std::min(1.0, tile.axis.dot(ray.bearing.cast<double>()));
        tile.half_angle = std::max(tile.half_angle, std::acos(cosine) + ray.d_u.norm() + ray.d_v.norm());
      }
    }
  }
}

cv::Mat Renderer::render(const Scene& scene, const Eigen::Isometry3d& T_world_cam, int threads) const {
  Shot shot;
  shot.origin = T_world_cam.translation();
  shot.R_world_cam = T_world_cam.linear();
  shot.hits.resize(rays_.size());
  shot.candidates.resize(tiles_.size());
  shot.image.create(height_, width_, CV_32FC1);
  parallelFor(tiles_y_, threads, [&](int tile_y) { castTileRow(scene, tile_y, &shot); });
  parallelFor(height_, threads, [&](int y) { shadeRow(scene, y, &shot); });
  return shot.image;
}

void Renderer::castTileRow(const Scene& scene, int tile_y, Shot* shot) const {
  for (int tile_x = 0; tile_x < tiles_x_; ++tile_x) {
    const Tile& tile = tiles_[tile_y * tiles_x_ + tile_x];
    std::vector<int>& boxes = shot->candidates[tile_y * tiles_x_ + tile_x];
    scene.boxesInCone(shot->origin, shot->R_world_cam * tile.axis, tile.half_angle, &boxes);
    for (int y = tile_y * kTile; y < std::min(height_, (tile_y + 1) * kTile); ++y) {
      for (int x = tile_x * kTile; x < std::min(width_, (tile_x + 1) * kTile); ++x) {
        const PixelRay& ray = rays_[y * width_ + x];
        if (ray.bearing.isZero()) continue;
        shot->hits[y * width_ + x] = scene.castRay(shot->origin, shot->R_world_cam * ray.bearing.cast<double>(), boxes);
      }
    }
  }
}

void Renderer::shadeRow(const Scene& scene, int y, Shot* shot) const {
  const auto surfaceAt = [&](int at_x, int at_y) {
    return shot->hits[std::clamp(at_y, 0, height_ - 1) * width_ + std::clamp(at_x, 0, width_ - 1)].surface;
  };
  float* row = shot->image.ptr<float>(y);
  for (int x = 0; x < width_; ++x) {
    const PixelRay& ray = rays_[y * width_ + x];
    if (ray.bearing.isZero()) {
      row[x] = 0.0f;
      continue;
    }
    const SceneHit& hit = shot->hits[y * width_ + x];
    const bool edge = surfaceAt(x - 1, y) != hit.surface || surfaceAt(x + 1, y) != hit.surface ||
                      surfaceAt(x, y - 1) != hit.surface || surfaceAt(x, y + 1) != hit.surface;
    if (edge) {
      row[x] = supersample(scene, ray, *shot, shot->candidates[y / kTile * tiles_x_ + x / kTile]);
      continue;
    }
    const Eigen::Vector3d direction = shot->R_world_cam * ray.bearing.cast<double>();
    const Eigen::Vector3d d_u = shot->R_world_cam * ray.d_u.cast<double>();
    const Eigen::Vector3d d_v = shot->R_world_cam * ray.d_v.cast<double>();
    const Eigen::Vector3d along = direction / hit.normal.dot(direction);
    row[x] =
        scene.shade(hit, shot->origin + hit.distance * direction, hit.distance * (d_u - along * hit.normal.dot(d_u)),
                    hit.distance * (d_v - along * hit.normal.dot(d_v)));
  }
}

float Renderer::supersample(const Scene& scene, const PixelRay& ray, const Shot& shot,
                            const std::vector<int>& boxes) const {
  const Eigen::Vector3d d_u = shot.R_world_cam * ray.d_u.cast<double>() / kSupersamples;
  const Eigen::Vector3d d_v = shot.R_world_cam * ray.d_v.cast<double>() / kSupersamples;
  const Eigen::Vector3d center = shot.R_world_cam * ray.bearing.cast<double>();
  float sum = 0.0f;
  for (int i = 0; i < kSupersamples; ++i) {
    for (int j = 0; j < kSupersamples; ++j) {
      const double middle = 0.5 * (kSupersamples - 1);
      const Eigen::Vector3d direction = (center + (j - middle) * d_u + (i - middle) * d_v).normalized();
      const SceneHit hit = scene.castRay(shot.origin, direction, boxes);
      const Eigen::Vector3d along = direction / hit.normal.dot(direction);
      sum +=
          scene.shade(hit, shot.origin + hit.distance * direction, hit.distance * (d_u - along * hit.normal.dot(d_u)),
                      hit.distance * (d_v - along * hit.normal.dot(d_v)));
    }
  }
  return sum / (kSupersamples * kSupersamples);
}

cv::Mat addImageNoise(const cv::Mat& image, double sigma, std::uint64_t seed, std::uint64_t stream) {
  // A table of normal numbers, read from a random place in each run of pixels.
  constexpr int kTableSize = 1 << 15, kRun = 64;
  static const std::vector<float> table = [] {
    Random random(1, 3);
    std::vector<float> numbers(kTableSize + kRun);
    for (float& number : numbers) number = static_cast<float>(random.gaussian());
    return numbers;
  }();
  Random random(seed, stream);
  cv::Mat noisy(image.size(), CV_8UC1);
  for (int y = 0; y < image.rows; ++y) {
    const float* in = image.ptr<float>(y);
    std::uint8_t* out = noisy.ptr<std::uint8_t>(y);
    for (int x = 0; x < image.cols; x += kRun) {
      const float* noise = table.data() + random.index(kTableSize);
      for (int i = x; i < std::min(image.cols, x + kRun); ++i) {
        out[i] = cv::saturate_cast<std::uint8_t>(in[i] + static_cast<float>(sigma) * noise[i - x]);
      }
    }
  }
  return noisy;
}

}  // namespace multicam_egomotion
