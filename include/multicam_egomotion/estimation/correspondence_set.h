// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "multicam_egomotion/geometry/ray.h"

namespace multicam_egomotion {

/// Ray correspondences of one frame pair, grouped by camera pair and laid out so that a pose is scored over all of them
/// with vector instructions. Indices are those of the order in which correspondences were given.
class CorrespondenceSet {
 public:
  struct Entry {
    RayCorrespondence rays;
    double pixels_per_radian1 = 1.0;  ///< image scale at the observation in the first frame [px/rad]
    double pixels_per_radian2 = 1.0;  ///< and in the second
  };
  /// Correspondences from one camera at t1 to one camera at t2.
  struct CameraPair {
    int camera1, camera2;
    Eigen::Vector3d center1, center2;  ///< camera centres in the body [m]
    int begin, end;                    ///< positions in the grouped order
  };

  /// `centers1`, `centers2`: camera centres in the body at t1 and t2 [m], by camera index.
  CorrespondenceSet(const std::vector<Entry>& entries, const std::vector<Eigen::Vector3d>& centers1,
                    const std::vector<Eigen::Vector3d>& centers2);

  int size() const { return static_cast<int>(entries_.size()); }
  const RayCorrespondence& rays(int index) const { return entries_[index].rays; }
  const std::vector<CameraPair>& cameraPairs() const { return pairs_; }
  /// Index of the correspondence at a grouped position.
  int indexAt(int position) const { return order_[position]; }
  double inverseSquaredScale1(int position) const { return columns_(position, 6); }  ///< at t1 [rad^2/px^2]
  double inverseSquaredScale2(int position) const { return columns_(position, 7); }  ///< at t2 [rad^2/px^2]
  /// Position of the camera pair of a correspondence in cameraPairs().
  int pairOf(int index) const { return pair_of_[index]; }

  /// Squared Sampson errors [px^2] of T_f2_f1 = [R t], in the grouped order, first order in the pixel noise of both
  /// images (each camera pair has its own epipolar geometry; bearings, so that fisheyes need no plane).
  void squaredSampsonErrors(const Eigen::Matrix3d& R, const Eigen::Vector3d& t, std::vector<double>* errors) const;

  /// MSAC score: sum of min(error^2, threshold^2) [px^2]; stops early above `best` (the result is then only > best).
  double score(const Eigen::Matrix3d& R, const Eigen::Vector3d& t, double squared_threshold, double best,
               std::vector<double>* buffer) const;

 private:
  void pairErrors(const CameraPair& pair, const Eigen::Matrix3d& R, const Eigen::Vector3d& t, double* errors) const;

  std::vector<Entry> entries_;
  std::vector<int> order_, pair_of_;
  std::vector<CameraPair> pairs_;
  Eigen::Matrix<double, Eigen::Dynamic, 8> columns_;  // x1 y1 z1 x2 y2 z2 1/k1^2 1/k2^2 in the grouped order
};

}  // namespace multicam_egomotion
