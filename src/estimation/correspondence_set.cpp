// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "multicam_egomotion/estimation/correspondence_set.h"

#include <algorithm>
#include <limits>
#include <map>
#include <utility>

#include "multicam_egomotion/estimation/random_index.h"
#include "sampson_kernels.h"

namespace multicam_egomotion {
namespace {

PairGeometry geometryOf(const RaySegment& segment, const Eigen::Matrix3d& R, const Eigen::Vector3d& t) {
  const Eigen::Vector3d baseline = R * segment.center1 + t - segment.center2;
  const double length = baseline.norm();
  // A comparison that NaN passes: it then shows in the errors.
  return {R, length < kNoBaseline ? Eigen::Vector3d::Zero() : Eigen::Vector3d(baseline / length)};
}

template <class T>
void put(const CorrespondenceSet::Entry& entry, int place, std::vector<RayBlock<T>>* blocks) {
  RayBlock<T>& block = (*blocks)[place / RayBlock<T>::kSize];
  const int k = place % RayBlock<T>::kSize;
  const Eigen::Vector3d &d1 = entry.rays.first.direction, &d2 = entry.rays.second.direction;
  const double s1 = entry.pixels_per_radian1, s2 = entry.pixels_per_radian2;
  const double values[] = {d1.x(), d1.y(), d1.z(), d2.x(), d2.y(), d2.z(), 1.0 / (s1 * s1), 1.0 / (s2 * s2), 1.0};
  T* const columns[] = {block.x1, block.y1, block.z1, block.x2, block.y2, block.z2, block.k1, block.k2, block.weight};
  for (int i = 0; i < 9; ++i) columns[i][k] = static_cast<T>(values[i]);
}

void copyPlace(const RayBlock<double>& from, int a, int b, RayBlock<double>* to) {
  to->x1[b] = from.x1[a];
  to->y1[b] = from.y1[a];
  to->z1[b] = from.z1[a];
  to->x2[b] = from.x2[a];
  to->y2[b] = from.y2[a];
  to->z2[b] = from.z2[a];
  to->k1[b] = from.k1[a];
  to->k2[b] = from.k2[a];
}

int ceilOfQuotient(int a, int b) { return (a + b - 1) / b; }

}  // namespace

CorrespondenceSet::CorrespondenceSet(std::vector<Entry> entries, const std::vector<Eigen::Vector3d>& centers1,
                                     const std::vector<Eigen::Vector3d>& centers2)
    : entries_(std::move(entries)), pair_of_(entries_.size()), centers1_(centers1) {
  std::map<std::pair<int, int>, std::vector<int>> groups;
  for (int i = 0; i < size(); ++i) groups[{entries_[i].rays.camera1, entries_[i].rays.camera2}].push_back(i);
  // The same blocks hold the same correspondences in both precisions: one of floats is as long as two of doubles.
  constexpr int kBlock = RayBlock<float>::kSize;
  constexpr int kRatio = kBlock / RayBlock<double>::kSize;
  RandomIndex random(0);
  for (auto& [cameras, members] : groups) {
    const int count = static_cast<int>(members.size());
    for (int i = 0; i + 1 < count; ++i) {
      std::swap(members[i], members[i + static_cast<int>(random.below(static_cast<std::uint32_t>(count - i)))]);
    }
    const int begin = static_cast<int>(float_.blocks.size()), end = begin + ceilOfQuotient(count, kBlock);
    const int probe = begin + std::min(ceilOfQuotient(count * kProbe, size() * kBlock), end - begin);
    const Eigen::Vector3d &center1 = centers1[cameras.first], &center2 = centers2[cameras.second];
    for (int i : members) pair_of_[i] = static_cast<int>(pairs_.size());
    pairs_.push_back({cameras.first, cameras.second, center1, center2, count});
    float_.segments.push_back({center1, center2, begin, probe, end, count});
    double_.segments.push_back({center1, center2, kRatio * begin, kRatio * probe, kRatio * end, count});
    float_.blocks.resize(end, RayBlock<float>{});
    double_.blocks.resize(kRatio * end, RayBlock<double>{});
    index_at_.resize(kBlock * end, -1);
    for (int i = 0; i < count; ++i) {
      const int place = kBlock * begin + i;
      index_at_[place] = members[i];
      put(entries_[members[i]], place, &float_.blocks);
      put(entries_[members[i]], place, &double_.blocks);
    }
  }
}

double CorrespondenceSet::sumOfLosses(const Eigen::Matrix3d& R, const Eigen::Vector3d& t, const RobustLoss& loss,
                                      Part part) const {
  double sum = 0.0;
  for (const RaySegment& segment : float_.segments) {
    const int begin = part == Part::kRest ? segment.probe : segment.begin;
    const int end = part == Part::kProbe ? segment.probe : segment.end;
    sum += multicam_egomotion::sumOfLosses(float_.blocks.data() + begin, end - begin, geometryOf(segment, R, t), loss);
  }
  return sum;
}

int CorrespondenceSet::partSize(Part part) const {
  int probe = 0;
  for (const RaySegment& s : float_.segments) probe += std::min(s.size, (s.probe - s.begin) * RayBlock<float>::kSize);
  return part == Part::kProbe ? probe : part == Part::kRest ? size() - probe : size();
}

void CorrespondenceSet::evaluate(const Eigen::Matrix3d& R, const Eigen::Vector3d& t, double limit,
                                 Residuals* residuals) const {
  constexpr int kBlock = RayBlock<double>::kSize;
  residuals->errors.resize(entries_.size());
  residuals->nearness.resize(entries_.size());
  residuals->leverages.resize(entries_.size());
  double mean_baseline = 0.0;
  for (const CameraPair& pair : pairs_) mean_baseline += (R * pair.center1 + t - pair.center2).norm() / pairs_.size();
  std::vector<RayResidual> rays(index_at_.size());
  for (const RaySegment& segment : double_.segments) {
    const int begin = kBlock * segment.begin;
    evaluateRays(double_.blocks.data() + segment.begin, segment.end - segment.begin, geometryOf(segment, R, t), limit,
                 rays.data() + begin);
    const double baseline = (R * segment.center1 + t - segment.center2).norm();
    const double scale = baseline > kNoBaseline ? mean_baseline / baseline : 0.0;
    for (int place = begin; place < begin + segment.size; ++place) {
      const int i = index_at_[place];
      residuals->errors[i] = rays[place].error;
      residuals->nearness[i] = scale * rays[place].nearness;
      residuals->leverages[i] = scale * scale * rays[place].squared_parallax;
    }
  }
}

RayBlocks<double> CorrespondenceSet::weightedBlocks(const std::vector<double>& weights) const {
  constexpr int kBlock = RayBlock<double>::kSize;
  RayBlocks<double> kept;
  kept.blocks.reserve(double_.blocks.size());
  for (const RaySegment& from : double_.segments) {
    RaySegment to = from;
    to.begin = static_cast<int>(kept.blocks.size());
    to.size = 0;
    for (int i = 0; i < from.size; ++i) {
      const double weight = weights[index_at_[kBlock * from.begin + i]];
      if (!(weight > 0.0)) continue;
      if (to.size % kBlock == 0) kept.blocks.push_back({});
      copyPlace(double_.blocks[from.begin + i / kBlock], i % kBlock, to.size % kBlock, &kept.blocks.back());
      kept.blocks.back().weight[to.size % kBlock] = weight;
      ++to.size;
    }
    to.probe = to.end = static_cast<int>(kept.blocks.size());
    if (to.size > 0) kept.segments.push_back(to);
  }
  return kept;
}

}  // namespace multicam_egomotion
