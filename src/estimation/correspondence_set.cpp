// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "multicam_egomotion/estimation/correspondence_set.h"

#include <algorithm>
#include <numeric>

#include "multicam_egomotion/geometry/so3.h"

namespace multicam_egomotion {

CorrespondenceSet::CorrespondenceSet(const std::vector<Entry>& entries, const std::vector<Eigen::Vector3d>& centers1,
                                     const std::vector<Eigen::Vector3d>& centers2)
    : entries_(entries), order_(entries.size()), pair_of_(entries.size()), columns_(entries.size(), 8) {
  std::iota(order_.begin(), order_.end(), 0);
  const auto key = [&](int i) { return std::make_pair(entries_[i].rays.camera1, entries_[i].rays.camera2); };
  std::stable_sort(order_.begin(), order_.end(), [&](int a, int b) { return key(a) < key(b); });
  for (int position = 0; position < size(); ++position) {
    const Entry& entry = entries_[order_[position]];
    const auto [camera1, camera2] = key(order_[position]);
    if (pairs_.empty() || pairs_.back().camera1 != camera1 || pairs_.back().camera2 != camera2) {
      pairs_.push_back({camera1, camera2, centers1[camera1], centers2[camera2], position, position});
    }
    pairs_.back().end = position + 1;
    pair_of_[order_[position]] = static_cast<int>(pairs_.size()) - 1;
    columns_.row(position) << entry.rays.first.direction.transpose(), entry.rays.second.direction.transpose(),
        1.0 / (entry.pixels_per_radian1 * entry.pixels_per_radian1),
        1.0 / (entry.pixels_per_radian2 * entry.pixels_per_radian2);
  }
}

void CorrespondenceSet::pairErrors(const CameraPair& pair, const Eigen::Matrix3d& R, const Eigen::Vector3d& t,
                                   double* errors) const {
  const Eigen::Vector3d baseline = R * pair.center1 + t - pair.center2;
  const Eigen::Matrix3d E = skew(baseline) * R;
  const Eigen::Index n = columns_.rows();
  const double* x1 = columns_.data();
  const double* y1 = x1 + n;
  const double* z1 = y1 + n;
  const double* x2 = z1 + n;
  const double* y2 = x2 + n;
  const double* z2 = y2 + n;
  const double* k1 = z2 + n;
  const double* k2 = k1 + n;
  const double e00 = E(0, 0), e01 = E(0, 1), e02 = E(0, 2), e10 = E(1, 0), e11 = E(1, 1), e12 = E(1, 2), e20 = E(2, 0),
               e21 = E(2, 1), e22 = E(2, 2);
  for (int i = pair.begin; i < pair.end; ++i) {
    const double ax = e00 * x1[i] + e01 * y1[i] + e02 * z1[i];  // E d1, normal of the epipolar plane at t2
    const double ay = e10 * x1[i] + e11 * y1[i] + e12 * z1[i];
    const double az = e20 * x1[i] + e21 * y1[i] + e22 * z1[i];
    const double bx = e00 * x2[i] + e10 * y2[i] + e20 * z2[i];  // E^T d2, at t1
    const double by = e01 * x2[i] + e11 * y2[i] + e21 * z2[i];
    const double bz = e02 * x2[i] + e12 * y2[i] + e22 * z2[i];
    const double e = ax * x2[i] + ay * y2[i] + az * z2[i];
    const double e2 = e * e;
    const double gradient2 = (ax * ax + ay * ay + az * az - e2) * k2[i] + (bx * bx + by * by + bz * bz - e2) * k1[i];
    errors[i] = e2 / (gradient2 + 1e-30);
  }
}

void CorrespondenceSet::squaredSampsonErrors(const Eigen::Matrix3d& R, const Eigen::Vector3d& t,
                                             std::vector<double>* errors) const {
  errors->resize(entries_.size());
  for (const CameraPair& pair : pairs_) pairErrors(pair, R, t, errors->data());
}

double CorrespondenceSet::score(const Eigen::Matrix3d& R, const Eigen::Vector3d& t, double squared_threshold,
                                double best, std::vector<double>* buffer) const {
  buffer->resize(entries_.size());
  double sum = 0.0;
  for (const CameraPair& pair : pairs_) {
    pairErrors(pair, R, t, buffer->data());
    for (int i = pair.begin; i < pair.end; ++i) sum += std::min((*buffer)[i], squared_threshold);
    if (sum > best) break;
  }
  return sum;
}

}  // namespace multicam_egomotion
