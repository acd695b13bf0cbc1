// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdio>
#include <memory>
#include <stdexcept>
#include <vector>

#include "simulator/simulator.h"

namespace multicam_egomotion {

/// Images of the first `frames` of a simulation and its IMU samples, kept in a temporary file: the memory of the
/// process is that of the odometry. Throws std::runtime_error when the file cannot be written or read.
class StoredLap {
 public:
  StoredLap(const Simulator& simulator, int frames) : cameras_(simulator.scenario().rig.size()) {
    for (int frame = 0; frame < frames; ++frame) {
      for (const CameraImage& image : simulator.renderFrame(frame).images) {
        size_ = image.grey.size();
        write(image.grey.data, image.grey.total());
      }
    }
    imu_begin_ = std::ftell(file_.get());
    const std::vector<ImuSample> samples = simulator.imuSamples();
    for (const ImuSample& sample : samples) {
      const Inertial values{sample.stamp_ns, sample.angular_velocity, sample.linear_acceleration};
      write(&values, sizeof(values));
    }
    samples_ = samples.size();
  }

  /// Images of a frame in memory of their own, as they are received.
  std::vector<CameraImage> images(int frame, std::int64_t stamp_ns) {
    std::vector<CameraImage> images;
    seek(static_cast<long>(frame) * cameras_ * size_.area());
    for (int camera = 0; camera < cameras_; ++camera) {
      cv::Mat grey(size_, CV_8UC1);
      read(grey.data, grey.total());
      images.push_back({camera, stamp_ns, grey});
    }
    return images;
  }

  /// The next samples up to a stamp.
  void appendImuUntil(std::int64_t stamp_ns, std::vector<ImuSample>* samples) {
    seek(imu_begin_ + static_cast<long>(next_ * sizeof(Inertial)));
    for (; next_ < samples_; ++next_) {
      Inertial values;
      read(&values, sizeof(values));
      if (values.stamp_ns > stamp_ns) return;
      ImuSample sample;
      sample.stamp_ns = values.stamp_ns;
      sample.angular_velocity = values.rate;
      sample.linear_acceleration = values.force;
      samples->push_back(sample);
    }
  }

 private:
  struct Inertial {
    std::int64_t stamp_ns;
    Eigen::Vector3d rate, force;
  };

  void write(const void* data, std::size_t size) {
    if (!file_ || std::fwrite(data, 1, size, file_.get()) != size) {
      throw std::runtime_error("a temporary file cannot be written");
    }
  }
  void read(void* data, std::size_t size) {
    if (std::fread(data, 1, size, file_.get()) != size) throw std::runtime_error("a temporary file cannot be read");
  }
  void seek(long place) {
    if (std::fseek(file_.get(), place, SEEK_SET) != 0) throw std::runtime_error("a temporary file cannot be read");
  }

  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  std::unique_ptr<std::FILE, Close> file_{std::tmpfile()};
  int cameras_;
  cv::Size size_;
  long imu_begin_ = 0;
  std::size_t samples_ = 0, next_ = 0;
};

}  // namespace multicam_egomotion
