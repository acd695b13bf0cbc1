// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "multicam_egomotion/odometry/frame_consensus.h"

#include <algorithm>
#include <cmath>

#include "multicam_egomotion/estimation/minimal_solvers.h"
#include "multicam_egomotion/geometry/covariance.h"
#include "multicam_egomotion/geometry/so3.h"

namespace multicam_egomotion {
namespace {

constexpr double kLeastBaseline = 1e-3;  // stands for a motion that is not known at all [m]
// The vertical at t2 follows from the predicted rotation; when that is worse than this, from a first estimate [rad].
constexpr double kWideRotation = 0.0175;
// Sigmas of a camera's rotation that must fit into the bound of an inlier for its matches with other cameras to count.
constexpr double kSurelyAligned = 3.0;
constexpr double kAxisSigmas = 20.0;  // the axis is used where the angle exceeds this many sigmas of its error

// Translation of a single camera pair whose rotation is known: its four-point samples are degenerate (central). The
// baseline lies in the epipolar planes of both correspondences; its length cannot be seen and is given.
struct TwoPointTranslation {
  static constexpr int kSampleSize = 2;
  struct Prior {
    Eigen::Matrix3d R;  // R_f2_f1
    Eigen::Vector3d center1, center2;
    double baseline;  // [m]
  };
  static std::vector<RelativePose> solve(const std::array<RayCorrespondence, 2>& sample, const Prior& prior,
                                         const SolverOptions&) {
    Eigen::Vector3d normals[2];
    for (int i = 0; i < 2; ++i) normals[i] = (prior.R * sample[i].first.direction).cross(sample[i].second.direction);
    Eigen::Vector3d b = normals[0].cross(normals[1]);
    const double length = b.norm();
    if (!(length > 1e-12)) return {};
    b *= prior.baseline / length;
    // A point in front of both views moves against the baseline's epipole: R d1 depth1 + b = d2 depth2.
    const Eigen::Vector3d d1 = prior.R * sample[0].first.direction;
    if ((b.cross(sample[0].second.direction)).dot(d1.cross(sample[0].second.direction)) > 0.0) b = -b;
    return {{prior.R, b - prior.R * prior.center1 + prior.center2, false}};
  }
};

}  // namespace

FrameConsensus findConsensus(const PosedFrame& previous, const PosedFrame& newest, const MotionSummary& motion,
                             const Eigen::Vector3d& up, const std::string& solver,
                             const RobustEstimatorOptions& options, std::uint64_t seed) {
  FrameConsensus consensus;
  const Eigen::Matrix3d R_f2_f1 = motion.T_a_b.linear().transpose();
  const TrackMatches matches = matchTracks(previous, newest, R_f2_f1, options.max_epipolar_error_px / kSurelyAligned);
  const CorrespondenceSet& set = matches.set;
  consensus.correspondences = static_cast<int>(set.size());

  // R_a_b Exp(d) transposed is Exp(-d) R_f2_f1, so the covariance is that of the left perturbation.
  MotionPriors priors;
  priors.rotation = {R_f2_f1, symmetricInverse(motion.rotation_covariance)};
  const Eigen::Vector3d rotation_vector = logSO3(R_f2_f1);
  const double angle_sigma = std::sqrt(symmetricEigenvalues(motion.rotation_covariance)[2]);
  RobustEstimate estimated;
  if (set.cameraPairs().size() == 1) {
    const CorrespondenceSet::CameraPair& pair = set.cameraPairs().front();
    const double baseline = std::max(motion.T_a_b.translation().norm(), kLeastBaseline);
    consensus.solver = "2pt-translation";
    estimated =
        estimate<TwoPointTranslation>(set, {R_f2_f1, pair.center1, pair.center2, baseline}, priors, options, seed);
  } else if (solver == "4pt-axis" || (solver == "auto" && rotation_vector.norm() > kAxisSigmas * angle_sigma)) {
    consensus.solver = "4pt-axis";
    estimated = estimate<FourPointAxis>(set, {rotation_vector}, priors, options, seed);
  } else {
    consensus.solver = "4pt-vertical";
    estimated = estimate<FourPointVertical>(set, verticalPriorFromUp(up, R_f2_f1 * up), priors, options, seed);
    if (angle_sigma > kWideRotation && estimated.success) {
      const Eigen::Matrix3d R = estimated.R;
      const RobustEstimate again =
          estimate<FourPointVertical>(set, verticalPriorFromUp(up, R * up), priors, options, seed);
      if (again.score < estimated.score) estimated = again;
    }
  }
  consensus.success = estimated.success;
  consensus.samples = estimated.samples;
  consensus.inliers = estimated.inlier_count;
  consensus.T_previous_body.linear() = estimated.R.transpose();
  consensus.T_previous_body.translation() = -estimated.R.transpose() * estimated.t;

  std::vector<double> parallax;
  for (std::size_t i = 0; i < matches.tracks.size(); ++i) {
    if (estimated.success && !estimated.inliers[i]) consensus.outliers.push_back(matches.tracks[i]);
    if (matches.parallax_px[i] >= 0.0 && (!estimated.success || estimated.inliers[i]))
      parallax.push_back(matches.parallax_px[i]);
  }
  consensus.outliers.erase(std::unique(consensus.outliers.begin(), consensus.outliers.end()), consensus.outliers.end());
  if (!parallax.empty()) {
    std::nth_element(parallax.begin(), parallax.begin() + parallax.size() / 2, parallax.end());
    consensus.parallax_px = parallax[parallax.size() / 2];
  }
  return consensus;
}

}  // namespace multicam_egomotion
