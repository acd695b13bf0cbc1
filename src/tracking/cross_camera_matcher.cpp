// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "multicam_egomotion/tracking/cross_camera_matcher.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "multicam_egomotion/tracking/image_curvature.h"

namespace multicam_egomotion {
namespace {

constexpr int kSearchPatchSize = 9;
constexpr double kMinSearchCorrelation = 0.6;
constexpr int kMaxHypotheses = 2000;
constexpr int kMaxCandidates = 3;
// Two candidates closer than this in the second image are the same match.
constexpr double kSameMatchPx = 3.0;

// The warp at a coarser pyramid level.
PatchWarp atLevel(const PatchWarp& warp, int level) {
  return {warp.pixel / (1 << level), warp.linear, warp.curvature * (1 << level)};
}

}  // namespace

CrossCameraMatcher::CrossCameraMatcher(const CameraRig& rig, const CrossCameraOptions& options)
    : rig_(rig), options_(options) {}

bool CrossCameraMatcher::warpAt(const Pair& pair, const ImagePoint& point, double inverse_distance,
                                PatchWarp* warp) const {
  const Eigen::Vector3d p = pair.T_to_from.linear() * point.bearing + inverse_distance * pair.T_to_from.translation();
  Eigen::Matrix<double, 2, 3> d_pixel_d_point;
  if (!rig_.camera(pair.to).model.project(p, &warp->pixel, &d_pixel_d_point)) return false;
  // A surface patch at equal distance from the first camera.
  warp->linear = d_pixel_d_point * pair.T_to_from.linear() * point.bearing_derivative;
  const double area = std::abs(warp->linear.determinant());
  return area > 0.1 && area < 10.0;
}

// Second order of the map from the second image, about `pixel`, into the first for a plane that faces the first camera.
// Where the images are curved differently, as at the edge of a fisheye, a patch cut by the linear part alone is matched
// some hundredths of a pixel aside.
Eigen::Matrix<double, 2, 3> CrossCameraMatcher::inverseCurvature(const Pair& pair, const ImagePoint& point,
                                                                 double inverse_distance,
                                                                 const Eigen::Vector2d& pixel) const {
  const CameraModel& from = rig_.camera(pair.from).model;
  const CameraModel& to = rig_.camera(pair.to).model;
  const Eigen::Matrix3d R_from_to = pair.T_to_from.linear().transpose();
  const Eigen::Vector3d shift = inverse_distance * (R_from_to * pair.T_to_from.translation());
  const double plane = 1.0 + point.bearing.dot(shift);
  bool seen = true;
  const auto map = [&](double x, double y) {
    Eigen::Vector3d bearing;
    Eigen::Vector2d mapped = Eigen::Vector2d::Zero();
    if (!to.unproject(pixel + Eigen::Vector2d(x, y), &bearing)) {
      seen = false;
      return mapped;
    }
    const Eigen::Vector3d direction = R_from_to * bearing;
    const double depth = plane / point.bearing.dot(direction);
    seen = seen && depth > 0.0 && from.project(depth * direction - shift, &mapped);
    return mapped;
  };
  const Eigen::Matrix<double, 2, 3> curvature = secondOrder(map, 0.35 * options_.patch_size_px);
  return seen ? curvature : Eigen::Matrix<double, 2, 3>::Zero();
}

bool CrossCameraMatcher::refine(const Pair& pair, const ImagePoint& point, double inverse_distance, int first_level,
                                WarpModel model, CrossCameraMatch* match, double* correlation) const {
  PatchWarp warp;
  if (!warpAt(pair, point, inverse_distance, &warp)) return false;
  PatchAlignmentOptions alignment;
  alignment.min_correlation = options_.min_correlation;
  PatchTemplate patch;
  const PatchWarp to_first{point.pixel, warp.linear.inverse(),
                           inverseCurvature(pair, point, inverse_distance, warp.pixel)};
  for (int level = first_level; level >= 0; --level) {
    // The template is cut through the inverse warp, so that the second image is sampled upright, which is cheap.
    // Coarse levels only bring the guess nearer; near the border or without texture there the finest alone decides.
    const PatchWarp from = atLevel(to_first, level);
    PatchWarp to{warp.pixel / (1 << level)};
    if (!patch.cut(pair.from_image[level], from, options_.patch_size_px,
                   level == 0 ? model : WarpModel::kTranslation) ||
        !patch.align(pair.to_image[level], alignment, &to, correlation)) {
      if (level == 0) return false;
      continue;
    }
    warp.pixel = to.pixel * (1 << level);
  }
  const CameraModel& camera = rig_.camera(pair.to).model;
  if (!camera.contains(warp.pixel) || !makeImagePoint(camera, warp.pixel, &match->point)) return false;

  match->inverse_distance = std::max(0.0, inverseDistance(point, match->point, pair.T_to_from));
  if (match->inverse_distance * options_.min_distance_m > 1.0) return false;
  const double max_error_px = options_.max_epipolar_error_px + pair.epipolar_slack_px;
  if (std::abs(epipolarError(point, match->point, pair.T_to_from)) > max_error_px) return false;
  // Beyond infinity: on the epipolar line, but not on the half that points project to.
  if (!warpAt(pair, point, match->inverse_distance, &warp)) return false;
  return (warp.pixel - match->point.pixel).norm() < 2.0 * max_error_px;
}

bool CrossCameraMatcher::reverses(const Pair& pair, const ImagePoint& point, const CrossCameraMatch& match) const {
  PatchWarp forward;
  if (!warpAt(pair, point, match.inverse_distance, &forward)) return false;
  PatchTemplate patch;
  if (!patch.cut(pair.to_image[0], {match.point.pixel, Eigen::Matrix2d::Identity()}, options_.patch_size_px,
                 WarpModel::kTranslation)) {
    return false;
  }
  PatchAlignmentOptions alignment;
  alignment.min_correlation = options_.min_correlation;
  PatchWarp back{point.pixel, forward.linear.inverse()};
  return patch.align(pair.from_image[0], alignment, &back) &&
         (back.pixel - point.pixel).norm() < options_.max_reverse_error_px;
}

void CrossCameraMatcher::collectCandidates(const Pair& pair, const ImagePoint& point,
                                           std::vector<Candidate>* candidates) const {
  candidates->clear();
  const CameraModel& model = rig_.camera(pair.to).model;
  const int level = options_.search_level;
  const Eigen::Matrix3d R = pair.T_to_from.linear();
  const Eigen::Vector3d t = pair.T_to_from.translation();
  const double max_inverse_distance = 1.0 / options_.min_distance_m;

  // The template is cut anew when the shape of the patch changes along the curve.
  PatchTemplate patch;
  Eigen::Matrix2d patch_linear = Eigen::Matrix2d::Zero();
  bool usable = false;
  Candidate previous{0, -1}, before{0, -1};
  const auto keepMaximum = [&](const Candidate& next) {
    if (previous.correlation > kMinSearchCorrelation && previous.correlation >= before.correlation &&
        previous.correlation > next.correlation) {
      candidates->push_back(previous);
    }
    before = previous;
    previous = next;
  };

  double rho = 0.0;
  for (int k = 0; k < kMaxHypotheses && rho <= max_inverse_distance; ++k) {
    Candidate next{rho, -1};
    Eigen::Vector2d pixel;
    Eigen::Matrix<double, 2, 3> d_pixel_d_point;
    if (!model.project(R * point.bearing + rho * t, &pixel, &d_pixel_d_point)) {
      // Not in the field of view (yet): the curve may enter it further on.
      keepMaximum(next);
      rho += 0.02 * max_inverse_distance;
      continue;
    }
    if (model.contains(pixel)) {
      const Eigen::Matrix2d linear = d_pixel_d_point * R * point.bearing_derivative;
      if ((linear - patch_linear).cwiseAbs().maxCoeff() > 0.1) {
        patch_linear = linear;
        const PatchWarp from{point.pixel / (1 << level), linear.inverse()};
        usable = std::abs(linear.determinant()) > 0.1 &&
                 patch.cut(pair.from_image[level], from, kSearchPatchSize, WarpModel::kTranslation);
      }
      if (usable) {
        next.correlation = patch.correlation(pair.to_image[level], {pixel / (1 << level), Eigen::Matrix2d::Identity()});
      }
    }
    keepMaximum(next);
    // One pixel of the search level a step.
    const double speed = (d_pixel_d_point * t).norm();
    rho += std::min(speed > 0 ? (1 << level) / speed : max_inverse_distance, 0.25 * max_inverse_distance);
  }
  keepMaximum({rho, -1});
  const auto keep = std::min<std::size_t>(kMaxCandidates, candidates->size());
  std::partial_sort(candidates->begin(), candidates->begin() + keep, candidates->end(),
                    [](const Candidate& a, const Candidate& b) { return a.correlation > b.correlation; });
  candidates->resize(keep);
}

std::optional<CrossCameraMatch> CrossCameraMatcher::search(const Pair& pair, const ImagePoint& point) const {
  std::vector<Candidate> candidates;
  collectCandidates(pair, point, &candidates);
  std::optional<CrossCameraMatch> best;
  double best_correlation = -1, second_correlation = -1;
  for (const Candidate& candidate : candidates) {
    CrossCameraMatch match;
    double correlation = -1;
    const bool found = refine(pair, point, candidate.inverse_distance, options_.search_level, WarpModel::kTranslation,
                              &match, &correlation);
    if (!found) continue;
    if (best && (match.point.pixel - best->point.pixel).norm() < kSameMatchPx) continue;
    if (correlation > best_correlation) {
      second_correlation = best_correlation;
      best_correlation = correlation;
      best = match;
    } else {
      second_correlation = std::max(second_correlation, correlation);
    }
  }
  if (best && best_correlation - second_correlation < options_.min_distinction) return std::nullopt;
  return best && reverses(pair, point, *best) ? best : std::nullopt;
}

std::optional<CrossCameraMatch> CrossCameraMatcher::rematch(const Pair& pair, const ImagePoint& point,
                                                            double inverse_distance, WarpModel model) const {
  // The finest level alone mostly suffices.
  for (const int first_level : {0, std::min(1, options_.search_level)}) {
    CrossCameraMatch match;
    double correlation = -1;
    if (refine(pair, point, inverse_distance, first_level, model, &match, &correlation)) return match;
  }
  return std::nullopt;
}

}  // namespace multicam_egomotion
