// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "multicam_egomotion/tracking/feature_tracker.h"

#include <algorithm>
#include <limits>
#include <mutex>
#include <opencv2/core/utility.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "multicam_egomotion/tracking/feature.h"

namespace multicam_egomotion {
namespace {

// A reference patch that fails in this many frames in a row is replaced by the newest one.
constexpr int kMaxReferenceFailures = 3;
// Change of shape, as a share, up to which a reference patch is kept at a keyframe.
constexpr double kMaxReferenceDeformation = 0.1;
// A feature without a match in an overlapping camera is looked for again every so many frames.
constexpr std::uint64_t kSearchPeriod = 5;
// Where the last predictions were this good, few pyramid levels come first, and all only for what these lose.
constexpr double kGoodPredictionPx = 4.0;
constexpr int kFewLevels = 2;
constexpr std::size_t kMinPredictionErrors = 10;
// Features are matched across cameras in so many groups at the same time.
constexpr double kMatchingGroups = 16;

void add(const FeatureTrackerCounters& more, FeatureTrackerCounters* counters) {
  counters->tracked += more.tracked;
  counters->rejected_forward_backward += more.rejected_forward_backward;
  counters->reference_aligned += more.reference_aligned;
  counters->cross_camera_matches += more.cross_camera_matches;
  counters->rejected_epipolar += more.rejected_epipolar;
}

}  // namespace

class FeatureTracker::Impl {
 public:
  Impl(const CameraRig& rig, const FeatureTrackerOptions& options)
      : rig_(rig),
        options_(options),
        flow_(opticalFlowOptions(options)),
        matcher_(rig_, crossCameraOptions(options)),
        border_px_(options.patch_size_px / 2 + 1) {
    check(options);
    makeDetectors();
    masks_.resize(rig_.size());
    current_.resize(rig_.size());
    previous_.resize(rig_.size());
    prediction_errors_.resize(rig_.size());
    max_prediction_error_.assign(rig_.size(), std::numeric_limits<double>::infinity());
  }

  void setMask(int camera, const cv::Mat& mask) {
    if (camera < 0 || camera >= rig_.size()) {
      throw std::invalid_argument("mask camera: found " + std::to_string(camera) + ", expected a camera of the rig");
    }
    const CameraModel& model = rig_.camera(camera).model;
    if (!mask.empty() && (mask.type() != CV_8UC1 || mask.cols != model.width() || mask.rows != model.height())) {
      throw std::invalid_argument("mask of camera " + std::to_string(camera) + ": found " + std::to_string(mask.cols) +
                                  "x" + std::to_string(mask.rows) + " of OpenCV type " + std::to_string(mask.type()) +
                                  ", expected " + std::to_string(model.width()) + "x" + std::to_string(model.height()) +
                                  " of CV_8UC1");
    }
    masks_[camera] = mask.clone();
  }

  void setDetection(const FeatureTrackerOptions& options) {
    FeatureTrackerOptions changed = options_;
    changed.features_per_camera = options.features_per_camera;
    changed.fast_threshold = options.fast_threshold;
    check(changed);
    options_ = changed;
    makeDetectors();
    std::vector<int> kept(rig_.size(), 0);
    const auto surplus = std::remove_if(features_.begin(), features_.end(), [&](const Feature& feature) {
      return ++kept[feature.owner] > options_.features_per_camera;
    });
    features_.erase(surplus, features_.end());
  }

  TrackedFrame track(const FrameSet& frames, const Eigen::Isometry3d& T_prev_cur,
                     const std::vector<Eigen::Isometry3d>& T_body_cam) {
    if (static_cast<int>(T_body_cam.size()) != rig_.size()) {
      throw std::invalid_argument("T_body_cam: found " + std::to_string(T_body_cam.size()) + " poses, expected " +
                                  std::to_string(rig_.size()));
    }
    const std::uint64_t ignored = counters_.ignored_images;
    counters_ = FeatureTrackerCounters();
    counters_.ignored_images = ignored;
    ++frame_;

    std::swap(previous_, current_);
    previous_T_body_cam_ = std::move(T_body_cam_);
    T_body_cam_ = T_body_cam;
    T_cur_prev_ = T_prev_cur.inverse();
    takeImages(frames);

    trackInTime();
    matchAcrossCameras();
    dropDead();
    detect();
    return output(frames.stamp_ns);
  }

  void markKeyframe() {
    for (Feature& feature : features_) {
      // A patch that still looks the same would only be replaced by one with the error of this alignment.
      const bool unchanged =
          feature.reference && feature.reference->failures == 0 &&
          (feature.reference->linear - Eigen::Matrix2d::Identity()).cwiseAbs().maxCoeff() < kMaxReferenceDeformation;
      if (!unchanged) makeReference(&feature);
    }
  }

  void remove(const std::vector<TrackId>& tracks) {
    for (const TrackId id : tracks) {
      const auto found = std::lower_bound(features_.begin(), features_.end(), id,
                                          [](const Feature& feature, TrackId wanted) { return feature.id < wanted; });
      if (found != features_.end() && found->id == id) found->alive = false;
    }
    features_.erase(std::remove_if(features_.begin(), features_.end(), [](const Feature& f) { return !f.alive; }),
                    features_.end());
  }

  void reset() {
    features_.clear();
    current_.assign(rig_.size(), FlowPyramid());
    previous_.assign(rig_.size(), FlowPyramid());
  }

  const FeatureTrackerCounters& counters() const { return counters_; }

 private:
  void makeDetectors() {
    detectors_.clear();
    for (const RigCamera& camera : rig_.cameras()) {
      detectors_.emplace_back(cv::Size(camera.model.width(), camera.model.height()), cornerDetectorOptions(options_));
    }
  }

  // Runs work(0, ...) ... work(count - 1, ...) in `groups` at the same time; each writes only what is its own, and
  // counts for itself. OpenCV's loops inside stay on the thread that calls them: they are too short to be shared out.
  template <typename Work>
  void atOnce(int count, double groups, const Work& work) {
    std::mutex mutex;
    const auto run = [&](const cv::Range& range) {
      FeatureTrackerCounters counters;
      for (int i = range.start; i < range.end; ++i) work(i, &counters);
      const std::lock_guard<std::mutex> lock(mutex);
      add(counters, &counters_);
    };
    cv::parallel_for_(cv::Range(0, count), run, groups);
  }

  void takeImages(const FrameSet& frames) {
    std::vector<const CameraImage*> taken(rig_.size(), nullptr);
    for (const CameraImage& image : frames.images) {
      const bool known = image.camera >= 0 && image.camera < rig_.size() && !taken[image.camera];
      if (!known || image.grey.type() != CV_8UC1 || image.grey.cols != rig_.camera(image.camera).model.width() ||
          image.grey.rows != rig_.camera(image.camera).model.height()) {
        ++counters_.ignored_images;
        continue;
      }
      taken[image.camera] = &image;
    }
    atOnce(rig_.size(), rig_.size(), [&](int camera, FeatureTrackerCounters*) {
      current_[camera] = taken[camera] ? FlowPyramid(taken[camera]->grey, flow_) : FlowPyramid();
    });
  }

  bool usable(int camera, const Eigen::Vector2d& pixel) const {
    if (!rig_.camera(camera).model.contains(pixel, border_px_)) return false;
    const cv::Mat& mask = masks_[camera];
    return mask.empty() || mask.at<uchar>(cvRound(pixel.y()), cvRound(pixel.x())) != 0;
  }

  // Motion of one camera: its optical frame at the previous frame to that of now.
  Eigen::Isometry3d motion(int camera) const {
    return T_body_cam_[camera].inverse() * T_cur_prev_ * previous_T_body_cam_[camera];
  }

  void trackInTime() {
    for (Feature& feature : features_) feature.alive = false;
    for (auto& errors : prediction_errors_) errors.clear();
    std::vector<std::vector<Feature*>> owned(rig_.size());
    for (Feature& feature : features_) owned[feature.owner].push_back(&feature);
    atOnce(rig_.size(), rig_.size(),
           [&](int camera, FeatureTrackerCounters* counters) { trackIn(camera, owned[camera], counters); });
    // What its camera lost may live on in another that saw it.
    std::vector<Feature*> group;
    for (int camera = 0; camera < rig_.size(); ++camera) {
      group.clear();
      for (Feature& feature : features_) {
        if (!feature.alive && feature.owner != camera && feature.seen[camera]) group.push_back(&feature);
      }
      counters_.handed_over += trackIn(camera, group, &counters_);
    }
    updatePredictionErrors();
  }

  // Tracks features of one camera from the previous frame and makes it their owner; returns how many succeeded.
  int trackIn(int camera, std::vector<Feature*> group, FeatureTrackerCounters* counters) {
    if (group.empty() || previous_[camera].empty() || current_[camera].empty()) return 0;
    const bool few_levels = max_prediction_error_[camera] < kGoodPredictionPx;
    const int levels = few_levels ? std::min(kFewLevels, flow_.pyramid_levels) : flow_.pyramid_levels;
    int tracked = flowIn(camera, levels, group, counters);
    if (few_levels) {
      group.erase(std::remove_if(group.begin(), group.end(), [](const Feature* f) { return f->alive; }), group.end());
      tracked += flowIn(camera, flow_.pyramid_levels, group, counters);
    }
    counters->tracked += tracked;
    return tracked;
  }

  int flowIn(int camera, int levels, const std::vector<Feature*>& group, FeatureTrackerCounters* counters) {
    std::vector<cv::Point2f> origins, guesses;
    std::vector<unsigned char> found;
    const Eigen::Isometry3d T_cur_prev = motion(camera);
    for (const Feature* feature : group) {
      const Eigen::Vector2d& pixel = feature->points[camera].pixel;
      const Eigen::Vector2d guess = predict(camera, T_cur_prev, *feature);
      origins.emplace_back(pixel.x(), pixel.y());
      guesses.emplace_back(guess.x(), guess.y());
    }
    std::vector<cv::Point2f> flowed = guesses;
    flowForward(previous_[camera], current_[camera], flow_, levels, origins, &flowed, &found);

    // Alignment to the reference vouches for a track; only without it the way back is worth its time.
    std::vector<Feature*> unaligned;
    std::vector<cv::Point2f> unaligned_origins, unaligned_points;
    int tracked = 0;
    for (std::size_t i = 0; i < group.size(); ++i) {
      if (!found[i]) continue;
      Feature& feature = *group[i];
      Eigen::Vector2d pixel(flowed[i].x, flowed[i].y);
      if (feature.owner != camera) cutReference(previous_[camera], feature.points[camera].pixel, &feature);
      if (!alignToReference(camera, &feature, &pixel, counters)) {
        unaligned.push_back(&feature);
        unaligned_origins.push_back(origins[i]);
        unaligned_points.push_back(flowed[i]);
      } else if (advance(camera, pixel, T_cur_prev, &feature)) {
        prediction_errors_[camera].push_back(static_cast<float>(cv::norm(flowed[i] - guesses[i])));
        ++tracked;
      }
    }
    flowReturns(previous_[camera], current_[camera], flow_, unaligned_origins, unaligned_points, &found);
    for (std::size_t i = 0; i < unaligned.size(); ++i) {
      Feature& feature = *unaligned[i];
      if (!found[i]) {
        ++counters->rejected_forward_backward;
      } else if (advance(camera, {unaligned_points[i].x, unaligned_points[i].y}, T_cur_prev, &feature)) {
        if (!feature.reference || ++feature.reference->failures >= kMaxReferenceFailures) makeReference(&feature);
        ++tracked;
      }
    }
    return tracked;
  }

  // Where a feature of the previous frame should be now; at infinity where its distance is unknown.
  Eigen::Vector2d predict(int camera, const Eigen::Isometry3d& T_cur_prev, const Feature& feature) const {
    const CameraModel& model = rig_.camera(camera).model;
    const ImagePoint& point = feature.points[camera];
    const double rho = feature.owner == camera ? std::max(0.0, feature.inverse_distance) : 0.0;
    Eigen::Vector2d pixel;
    const bool visible = model.project(T_cur_prev.linear() * point.bearing + rho * T_cur_prev.translation(), &pixel) &&
                         model.contains(pixel);
    return visible ? pixel : point.pixel;
  }

  // Moves a feature to `pixel` of the newest image of a camera, which then owns it.
  bool advance(int camera, const Eigen::Vector2d& pixel, const Eigen::Isometry3d& T_cur_prev, Feature* feature) {
    ImagePoint point;
    if (!usable(camera, pixel) || !makeImagePoint(rig_.camera(camera).model, pixel, &point)) return false;
    if (feature->owner != camera) {
      feature->inverse_distance = -1.0;
    } else if (feature->inverse_distance > 0) {
      const Eigen::Vector3d p =
          T_cur_prev.linear() * feature->points[camera].bearing / feature->inverse_distance + T_cur_prev.translation();
      feature->inverse_distance = 1.0 / std::max(options_.min_distance_m, p.norm());
    }
    feature->owner = camera;
    feature->points[camera] = point;
    feature->seen[camera] = true;
    feature->alive = true;
    return true;
  }

  void updatePredictionErrors() {
    for (int camera = 0; camera < rig_.size(); ++camera) {
      std::vector<float>& errors = prediction_errors_[camera];
      max_prediction_error_[camera] = std::numeric_limits<double>::infinity();
      if (errors.size() < kMinPredictionErrors) continue;
      const auto rank = errors.begin() + errors.size() * 9 / 10;
      std::nth_element(errors.begin(), rank, errors.end());
      max_prediction_error_[camera] = *rank;
    }
  }

  bool alignToReference(int camera, Feature* feature, Eigen::Vector2d* pixel, FeatureTrackerCounters* counters) {
    if (!feature->reference) return false;
    ReferencePatch& reference = *feature->reference;
    PatchAlignmentOptions alignment;
    alignment.max_shift_px = options_.max_reference_correction_px;
    PatchWarp warp{*pixel, reference.linear};
    if (!reference.patch.align(current_[camera].images()[0], alignment, &warp)) return false;
    reference.linear = warp.linear;
    reference.failures = 0;
    *pixel = warp.pixel;
    ++counters->reference_aligned;
    return true;
  }

  void makeReference(Feature* feature) {
    if (!current_[feature->owner].empty()) {
      cutReference(current_[feature->owner], feature->points[feature->owner].pixel, feature);
    }
  }

  void cutReference(const FlowPyramid& pyramid, const Eigen::Vector2d& pixel, Feature* feature) {
    if (!feature->reference) feature->reference = std::make_unique<ReferencePatch>();
    feature->reference->linear.setIdentity();
    feature->reference->failures = 0;
    if (!feature->reference->patch.cut(pyramid.images()[0], {pixel, Eigen::Matrix2d::Identity()},
                                       options_.patch_size_px, WarpModel::kAffine)) {
      feature->reference.reset();
    }
  }

  void matchAcrossCameras() {
    atOnce(static_cast<int>(features_.size()), kMatchingGroups, [&](int i, FeatureTrackerCounters* counters) {
      Feature& feature = features_[i];
      if (!feature.alive) return;
      for (int camera = 0; camera < rig_.size(); ++camera) {
        if (camera == feature.owner) continue;
        const bool was_seen = std::exchange(feature.seen[camera], false);
        matchInto(camera, was_seen, &feature, counters);
        if (was_seen && !feature.seen[camera]) ++counters->rejected_epipolar;
      }
    });
  }

  void matchInto(int camera, bool was_seen, Feature* feature, FeatureTrackerCounters* counters) {
    const auto& overlapping = rig_.overlappingCameras(feature->owner);
    if (current_[camera].empty() || std::find(overlapping.begin(), overlapping.end(), camera) == overlapping.end()) {
      return;
    }
    const CrossCameraMatcher::Pair pair{feature->owner, camera, current_[feature->owner].images(),
                                        current_[camera].images(),
                                        T_body_cam_[camera].inverse() * T_body_cam_[feature->owner]};
    const ImagePoint& point = feature->points[feature->owner];
    std::optional<CrossCameraMatch> match;
    if (was_seen && feature->inverse_distance >= 0) {
      match = matcher_.rematch(pair, point, feature->inverse_distance);
    } else if ((feature->id + frame_) % kSearchPeriod == 0 || was_seen) {
      match = matcher_.search(pair, point);
    }
    if (!match || !usable(camera, match->point.pixel)) return;
    feature->seen[camera] = true;
    feature->points[camera] = match->point;
    feature->inverse_distance = match->inverse_distance;
    ++counters->cross_camera_matches;
  }

  void dropDead() {
    const auto dead = std::remove_if(features_.begin(), features_.end(), [](const Feature& f) { return !f.alive; });
    counters_.lost = static_cast<int>(features_.end() - dead);
    features_.erase(dead, features_.end());
  }

  void detect() {
    std::vector<cv::Point2f> occupied;
    for (int camera = 0; camera < rig_.size(); ++camera) {
      if (current_[camera].empty()) continue;
      occupied.clear();
      for (const Feature& feature : features_) {
        if (!feature.seen[camera]) continue;
        const Eigen::Vector2d& pixel = feature.points[camera].pixel;
        occupied.emplace_back(pixel.x(), pixel.y());
      }
      for (const cv::Point2f& corner :
           detectors_[camera].detect(current_[camera].images()[0], masks_[camera], occupied)) {
        addFeature(camera, {corner.x, corner.y});
      }
    }
  }

  void addFeature(int camera, const Eigen::Vector2d& pixel) {
    Feature feature;
    feature.owner = camera;
    if (!usable(camera, pixel) || !makeImagePoint(rig_.camera(camera).model, pixel, &feature.points[camera])) return;
    feature.id = next_id_++;
    feature.seen[camera] = true;
    makeReference(&feature);
    for (const int other : rig_.overlappingCameras(camera)) matchInto(other, true, &feature, &counters_);
    ++counters_.detected;
    features_.push_back(std::move(feature));
  }

  TrackedFrame output(std::int64_t stamp_ns) const {
    TrackedFrame frame;
    frame.stamp_ns = stamp_ns;
    for (const Feature& feature : features_) {
      for (int camera = 0; camera < rig_.size(); ++camera) {
        if (!feature.seen[camera]) continue;
        const ImagePoint& point = feature.points[camera];
        frame.observations.push_back({feature.id, camera, point.pixel, point.bearing, bearingToPixel(point)});
      }
    }
    return frame;
  }

  CameraRig rig_;
  FeatureTrackerOptions options_;
  OpticalFlowOptions flow_;
  CrossCameraMatcher matcher_;
  double border_px_;
  std::vector<CornerDetector> detectors_;
  std::vector<cv::Mat> masks_;

  std::vector<FlowPyramid> current_, previous_;  // by camera; empty where the image was missing
  std::vector<Eigen::Isometry3d> T_body_cam_, previous_T_body_cam_;
  Eigen::Isometry3d T_cur_prev_ = Eigen::Isometry3d::Identity();
  std::vector<Feature> features_;  // by id
  TrackId next_id_ = 1;
  std::uint64_t frame_ = 0;
  FeatureTrackerCounters counters_;

  // Error [px] that 9 of 10 predictions of the last frame stayed within, by camera.
  std::vector<double> max_prediction_error_;
  std::vector<std::vector<float>> prediction_errors_;
};

FeatureTracker::FeatureTracker(const CameraRig& rig, const FeatureTrackerOptions& options)
    : impl_(std::make_unique<Impl>(rig, options)) {}
FeatureTracker::~FeatureTracker() = default;
FeatureTracker::FeatureTracker(FeatureTracker&&) noexcept = default;
FeatureTracker& FeatureTracker::operator=(FeatureTracker&&) noexcept = default;

void FeatureTracker::setMask(int camera, const cv::Mat& mask) { impl_->setMask(camera, mask); }
void FeatureTracker::setDetection(const FeatureTrackerOptions& options) { impl_->setDetection(options); }
TrackedFrame FeatureTracker::track(const FrameSet& frames, const Eigen::Isometry3d& T_prev_cur,
                                   const std::vector<Eigen::Isometry3d>& T_body_cam) {
  return impl_->track(frames, T_prev_cur, T_body_cam);
}
void FeatureTracker::markKeyframe() { impl_->markKeyframe(); }
void FeatureTracker::remove(const std::vector<TrackId>& tracks) { impl_->remove(tracks); }
void FeatureTracker::reset() { impl_->reset(); }
const FeatureTrackerCounters& FeatureTracker::counters() const { return impl_->counters(); }

}  // namespace multicam_egomotion
