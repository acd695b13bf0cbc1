// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "bag_runner/trajectory_files.h"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <stdexcept>

namespace multicam_egomotion {
namespace {

void openForWriting(const std::string& path, std::ofstream* file) {
  file->open(path);
  if (!*file) throw std::runtime_error("'" + path + "' cannot be written: " + std::strerror(errno));
}

/// After a failure, before anything else can overwrite its reason.
void checkWritten(const std::string& path, const std::ofstream& file) {
  if (!file) throw std::runtime_error("'" + path + "': not everything could be written: " + std::strerror(errno));
}

void closeWritten(const std::string& path, std::ofstream* file) {
  file->close();
  checkWritten(path, *file);
}

}  // namespace

TumFile::TumFile(const std::string& path) : path_(path) { openForWriting(path, &file_); }

void TumFile::write(std::int64_t stamp_ns, const Eigen::Isometry3d& T_odom_body) {
  const Eigen::Vector3d p = T_odom_body.translation();
  const Eigen::Quaterniond q(T_odom_body.linear());
  char line[256];
  std::snprintf(line, sizeof(line), "%lld.%09lld %.9f %.9f %.9f %.9f %.9f %.9f %.9f\n",
                static_cast<long long>(stamp_ns / 1000000000), static_cast<long long>(stamp_ns % 1000000000), p.x(),
                p.y(), p.z(), q.x(), q.y(), q.z(), q.w());
  file_ << line;
  checkWritten(path_, file_);
}

void TumFile::close() { closeWritten(path_, &file_); }

KittiFile::KittiFile(const std::string& path, const Eigen::Isometry3d& T_body_cam0)
    : path_(path), T_body_cam0_(T_body_cam0) {
  openForWriting(path, &file_);
}

void KittiFile::addPose(std::int64_t image_stamp_ns, const Eigen::Isometry3d& T_odom_body) {
  poses_.emplace_back(image_stamp_ns, T_odom_body * T_body_cam0_);
}

void KittiFile::close() {
  std::stable_sort(poses_.begin(), poses_.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::sort(image_stamps_ns_.begin(), image_stamps_ns_.end());
  Eigen::Isometry3d T_first_cam0 = Eigen::Isometry3d::Identity();
  auto next = poses_.begin();
  for (const std::int64_t stamp_ns : image_stamps_ns_) {
    for (; next != poses_.end() && next->first <= stamp_ns; ++next) {
      T_first_cam0 = poses_.front().second.inverse() * next->second;
    }
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 4; ++column) {
        char number[40];
        std::snprintf(number, sizeof(number), row + column == 0 ? "%.9e" : " %.9e", T_first_cam0(row, column));
        file_ << number;
      }
    }
    file_ << '\n';
  }
  closeWritten(path_, &file_);
}

}  // namespace multicam_egomotion
