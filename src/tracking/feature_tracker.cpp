// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "multicam_egomotion/tracking/feature_tracker.h"

#include <algorithm>
#include <mutex>
#include <opencv2/core/utility.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "multicam_egomotion/tracking/departed_features.h"
#include "multicam_egomotion/tracking/feature.h"
#include "multicam_egomotion/tracking/temporal_tracker.h"

namespace multicam_egomotion {
namespace {

// Change of shape, as a share, up to which a reference patch is kept at a keyframe.
constexpr double kMaxReferenceDeformation = 0.1;
// A feature without a match in an overlapping camera is looked for again every so many frames.
constexpr std::uint64_t kSearchPeriod = 5;
// Parts, at most, that work for several threads is cut into.
constexpr double kParts = 16;

}  // namespace

class FeatureTracker::Impl {
 public:
  Impl(const CameraRig& rig, const FeatureTrackerOptions& options)
      : rig_(rig),
        options_(options),
        regions_(rig_, options.patch_size_px / 2 + 1),
        temporal_(rig_, regions_, options),
        matcher_(rig_, crossCameraOptions(options)),
        departed_(rig_, regions_, matcher_) {
    check(options);
    makeDetectors();
    forgetImages();
  }

  void setMask(int camera, const cv::Mat& mask) { regions_.setMask(camera, mask); }

  void setEpipolarSlack(const std::vector<double>& slack_px) { images_.epipolar_slack_px = slack_px; }

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
    if (resumed_frame_ != frame_) departed_.clear();  // it is not known how they moved on
    ++frame_;

    std::swap(images_.previous, images_.current);
    images_.previous_T_body_cam = std::move(images_.T_body_cam);
    images_.T_body_cam = T_body_cam;
    images_.T_cur_prev = T_prev_cur.inverse();
    takeImages(frames);

    trackInTime();
    matchAcrossCameras();
    dropDead();
    newborn_ = next_id_;
    detect();
    return output(frames.stamp_ns);
  }

  void resume(const std::vector<TrackedPoint>& points, const Eigen::Isometry3d& T_prev_cur) {
    for (Feature& found : departed_.find(points, T_prev_cur.inverse(), images_)) {
      makeReference(&found);
      replaceNewborn(found);
      const auto next = std::lower_bound(features_.begin(), features_.end(), found.id, beforeId);
      features_.insert(next, std::move(found));
      ++counters_.handed_over;
    }
    resumed_frame_ = frame_;
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
      const auto found = std::lower_bound(features_.begin(), features_.end(), id, beforeId);
      if (found != features_.end() && found->id == id) found->alive = false;
    }
    features_.erase(std::remove_if(features_.begin(), features_.end(), [](const Feature& f) { return !f.alive; }),
                    features_.end());
  }

  void reset() {
    features_.clear();
    forgetImages();
  }

  const FeatureTrackerCounters& counters() const { return counters_; }

 private:
  static bool beforeId(const Feature& feature, TrackId id) { return feature.id < id; }

  // Ends what was only just detected where a feature goes on.
  void replaceNewborn(const Feature& feature) {
    const auto same = [&](const Feature& other) {
      const int camera = feature.owner;
      return other.seen[camera] &&
             (other.points[camera].pixel - feature.points[camera].pixel).norm() < options_.min_distance_px;
    };
    const auto newborn = std::lower_bound(features_.begin(), features_.end(), newborn_, beforeId);
    features_.erase(std::remove_if(newborn, features_.end(), same), features_.end());
  }

  void forgetImages() {
    departed_.clear();
    images_.current.assign(rig_.size(), FlowPyramid());
    images_.previous.assign(rig_.size(), FlowPyramid());
  }

  void makeDetectors() {
    detectors_.clear();
    for (const RigCamera& camera : rig_.cameras()) {
      detectors_.emplace_back(cv::Size(camera.model.width(), camera.model.height()), cornerDetectorOptions(options_));
    }
  }

  // Runs work(0, ...) ... work(count - 1, ...) at the same time; each writes only what is its own, and counts for
  // itself. OpenCV's loops inside stay on the thread that calls them: they are too short to be shared out.
  template <typename Work>
  void atOnce(int count, const Work& work) {
    std::mutex mutex;
    const auto run = [&](const cv::Range& range) {
      FeatureTrackerCounters counters;
      for (int i = range.start; i < range.end; ++i) work(i, &counters);
      const std::lock_guard<std::mutex> lock(mutex);
      counters_ += counters;
    };
    cv::parallel_for_(cv::Range(0, count), run, kParts);
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
    atOnce(rig_.size(), [&](int camera, FeatureTrackerCounters*) {
      FlowPyramid& pyramid = images_.current[camera];
      if (taken[camera]) {
        pyramid.build(taken[camera]->grey, temporal_.flow());
      } else {
        pyramid = FlowPyramid();
      }
    });
  }

  void trackInTime() {
    for (Feature& feature : features_) feature.alive = false;
    std::vector<std::vector<Feature*>> owned(rig_.size());
    for (Feature& feature : features_) owned[feature.owner].push_back(&feature);
    atOnce(rig_.size(), [&](int camera, FeatureTrackerCounters* counters) {
      temporal_.track(images_, camera, owned[camera], counters);
    });
    // What its camera lost may live on in another that saw it.
    std::vector<Feature*> group;
    for (int camera = 0; camera < rig_.size(); ++camera) {
      group.clear();
      for (Feature& feature : features_) {
        if (!feature.alive && feature.owner != camera && feature.seen[camera]) group.push_back(&feature);
      }
      counters_.handed_over += temporal_.track(images_, camera, group, &counters_);
    }
    temporal_.endFrame();
  }

  void makeReference(Feature* feature) {
    const FlowPyramid& pyramid = images_.current[feature->owner];
    if (pyramid.empty()) return;
    temporal_.cutReference(feature->owner, pyramid, feature->points[feature->owner].pixel, feature);
  }

  void matchAcrossCameras() {
    atOnce(static_cast<int>(features_.size()), [&](int i, FeatureTrackerCounters* counters) {
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
    if (images_.current[camera].empty() ||
        std::find(overlapping.begin(), overlapping.end(), camera) == overlapping.end()) {
      return;
    }
    const CrossCameraMatcher::Pair pair{feature->owner,
                                        camera,
                                        images_.current[feature->owner].images(),
                                        images_.current[camera].images(),
                                        images_.T_body_cam[camera].inverse() * images_.T_body_cam[feature->owner],
                                        images_.slackBetween(camera, feature->owner)};
    const ImagePoint& point = feature->points[feature->owner];
    std::optional<CrossCameraMatch> match;
    if (was_seen && feature->inverse_distance >= 0) {
      match = matcher_.rematch(pair, point, feature->inverse_distance);
    } else if ((feature->id + frame_) % kSearchPeriod == 0 || was_seen) {
      match = matcher_.search(pair, point);
    }
    if (!match || !regions_.contain(camera, match->point.pixel)) return;
    feature->points[camera] = match->point;
    feature->seen[camera] = true;
    feature->inverse_distance = match->inverse_distance;
    ++counters->cross_camera_matches;
  }

  void dropDead() {
    if (rig_.size() > 1) {
      for (const Feature& feature : features_) {
        if (!feature.alive) departed_.add(images_, feature);
      }
    }
    const auto dead = std::remove_if(features_.begin(), features_.end(), [](const Feature& f) { return !f.alive; });
    counters_.lost = static_cast<int>(features_.end() - dead);
    features_.erase(dead, features_.end());
  }

  void detect() {
    std::vector<cv::Point2f> occupied;
    for (int camera = 0; camera < rig_.size(); ++camera) {
      if (images_.current[camera].empty()) continue;
      occupied.clear();
      for (const Feature& feature : features_) {
        if (!feature.seen[camera]) continue;
        const Eigen::Vector2d& pixel = feature.points[camera].pixel;
        occupied.emplace_back(pixel.x(), pixel.y());
      }
      for (const cv::Point2f& corner :
           detectors_[camera].detect(images_.current[camera].images()[0], regions_.mask(camera), occupied)) {
        addFeature(camera, {corner.x, corner.y});
      }
    }
  }

  void addFeature(int camera, const Eigen::Vector2d& pixel) {
    Feature feature;
    feature.owner = camera;
    if (!regions_.contain(camera, pixel)) return;
    if (!makeImagePoint(rig_.camera(camera).model, pixel, &feature.points[camera])) return;
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
  FeatureRegions regions_;
  TemporalTracker temporal_;
  CrossCameraMatcher matcher_;
  DepartedFeatures departed_;
  std::vector<CornerDetector> detectors_;

  FramePair images_;
  std::vector<Feature> features_;  // by id
  TrackId next_id_ = 1;
  TrackId newborn_ = 1;  ///< first that was detected in the newest frame
  std::uint64_t frame_ = 0, resumed_frame_ = 0;
  FeatureTrackerCounters counters_;
};

FeatureTracker::FeatureTracker(const CameraRig& rig, const FeatureTrackerOptions& options)
    : impl_(std::make_unique<Impl>(rig, options)) {}
FeatureTracker::~FeatureTracker() = default;
FeatureTracker::FeatureTracker(FeatureTracker&&) noexcept = default;
FeatureTracker& FeatureTracker::operator=(FeatureTracker&&) noexcept = default;

void FeatureTracker::setMask(int camera, const cv::Mat& mask) { impl_->setMask(camera, mask); }
void FeatureTracker::setDetection(const FeatureTrackerOptions& options) { impl_->setDetection(options); }
void FeatureTracker::setEpipolarSlack(const std::vector<double>& slack_px) { impl_->setEpipolarSlack(slack_px); }
TrackedFrame FeatureTracker::track(const FrameSet& frames, const Eigen::Isometry3d& T_prev_cur,
                                   const std::vector<Eigen::Isometry3d>& T_body_cam) {
  return impl_->track(frames, T_prev_cur, T_body_cam);
}
void FeatureTracker::resume(const std::vector<TrackedPoint>& points, const Eigen::Isometry3d& T_prev_cur) {
  impl_->resume(points, T_prev_cur);
}
void FeatureTracker::markKeyframe() { impl_->markKeyframe(); }
void FeatureTracker::remove(const std::vector<TrackId>& tracks) { impl_->remove(tracks); }
void FeatureTracker::reset() { impl_->reset(); }
const FeatureTrackerCounters& FeatureTracker::counters() const { return impl_->counters(); }

}  // namespace multicam_egomotion
