// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "multicam_egomotion/estimation/ray_blocks.h"
#include "multicam_egomotion/estimation/robust_loss.h"
#include "multicam_egomotion/geometry/ray.h"

namespace multicam_egomotion {

/// Ray correspondences of one frame pair, grouped by camera pair and laid out so that a pose is scored over all of them
/// with vector instructions. Indices are those of the order in which correspondences were given.
/// Errors are Sampson errors [px], first order in the pixel noise of both images (each camera pair has its own epipolar
/// geometry; bearings, so that fisheyes need no plane).
class CorrespondenceSet {
 public:
  struct Entry {
    RayCorrespondence rays;
    double pixels_per_radian1 = 1.0;  ///< image scale at the observation in the first frame [px/rad]
    double pixels_per_radian2 = 1.0;  ///< and in the second
    double quality = 0.0;             ///< for PROSAC: the better, the higher; any unit
  };
  /// Correspondences from one camera at t1 to one camera at t2.
  struct CameraPair {
    int camera1, camera2;
    Eigen::Vector3d center1, center2;  ///< camera centres in the body [m]
    int size;
  };
  /// The probe is a random part of about kProbe correspondences; with the rest it is all.
  enum class Part { kProbe, kRest, kAll };
  static constexpr int kProbe = 128;

  /// `centers1`, `centers2`: camera centres in the body at t1 and t2 [m], by camera index.
  CorrespondenceSet(std::vector<Entry> entries, const std::vector<Eigen::Vector3d>& centers1,
                    const std::vector<Eigen::Vector3d>& centers2);

  int size() const { return static_cast<int>(entries_.size()); }
  const RayCorrespondence& rays(int index) const { return entries_[index].rays; }
  double quality(int index) const { return entries_[index].quality; }
  const std::vector<CameraPair>& cameraPairs() const { return pairs_; }
  /// Position of the camera pair of a correspondence in cameraPairs().
  int pairOf(int index) const { return pair_of_[index]; }
  const std::vector<Eigen::Vector3d>& centers1() const { return centers1_; }

  /// Sum of the losses of T_f2_f1 = [R t] over a part of the correspondences. A point that lies behind a camera counts
  /// as an outlier.
  double sumOfLosses(const Eigen::Matrix3d& R, const Eigen::Vector3d& t, const RobustLoss& loss, Part part) const;
  int partSize(Part part) const;

  /// By index.
  struct Residuals {
    std::vector<double> errors;     ///< absolute [px]; infinite for a point that would lie behind a camera
    std::vector<double> nearness;   ///< inverse distance at t2, in inverse mean baselines of the camera pairs
    std::vector<double> leverages;  ///< on the translation: squared sine of the angle between the bearings, over the
                                    ///< square of the pair's baseline in mean baselines
  };
  /// Points lie behind a camera when their bearings turn the wrong way by more than `limit` [px].
  void evaluate(const Eigen::Matrix3d& R, const Eigen::Vector3d& t, double limit, Residuals* residuals) const;

  /// For steps towards a solution: everything, with weight 1.
  const RayBlocks<float>& blocks() const { return float_; }
  /// For the refinement: what has a weight, by index.
  RayBlocks<double> weightedBlocks(const std::vector<double>& weights) const;

 private:
  std::vector<Entry> entries_;
  std::vector<int> pair_of_;
  std::vector<CameraPair> pairs_;
  std::vector<Eigen::Vector3d> centers1_;
  std::vector<int> index_at_;  // by place in the blocks of doubles; -1 where there is none
  RayBlocks<double> double_;
  RayBlocks<float> float_;
};

}  // namespace multicam_egomotion
