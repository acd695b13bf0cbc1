// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "multicam_egomotion/odometry/ego_motion.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <unordered_set>

#include "multicam_egomotion/geometry/so3.h"
#include "multicam_egomotion/imu/gyroscope_check.h"
#include "multicam_egomotion/imu/imu_buffer.h"
#include "multicam_egomotion/imu/imu_monitor.h"
#include "multicam_egomotion/imu/imu_mounting.h"
#include "multicam_egomotion/odometry/feature_report.h"
#include "multicam_egomotion/odometry/frame_consensus.h"
#include "multicam_egomotion/odometry/motion_model.h"
#include "multicam_egomotion/odometry/published_pose.h"
#include "multicam_egomotion/odometry/systematic_drift.h"

namespace multicam_egomotion {
namespace {

constexpr double kMovingParallax = 1.0;        // image motion that shows a translation for certain [px]
constexpr double kUnknownSpeedShare = 0.2;     // of the velocity's sigma, taken for the speed of which nothing is known
constexpr double kFarDistance = 20.0;          // what does not move in the images is taken to be no further away [m]
constexpr double kUnknownDistance = 100.0;     // sigma of a displacement of which only the direction is seen [m]
constexpr double kStillParallax = 0.1;         // image motion that cannot be told from none [px]
constexpr double kJumpBack = 0.5;              // stamps that go back by more are a jump of the clock [s]
constexpr double kJumpPositionSigma = 1.0;     // contract 13 [m]
constexpr double kJumpAttitudeSigma = 0.1745;  // contract 13: 10 deg [rad]
constexpr double kDefaultPeriod = 0.1;         // between frame sets until it has been measured [s]
constexpr double kSettledTilt = 0.0175;        // sigma of the vertical from which odom is settled: 1 deg [rad]
constexpr double kMaxSettling = 2.0;           // settled after that in any case [s]
constexpr double kFewInliers = 0.5;            // share of the tracks below which the gyroscope may be wrong
constexpr double kManyMore = 1.5;              // times the inliers without the gyroscope, if it is
constexpr double kDoubtedRotation = 0.35;      // sigma of its rotation then [rad]
constexpr double kImuHistory = 3.0;            // kept before the newest frame [s]

double seconds(std::int64_t ns) { return 1e-9 * static_cast<double>(ns); }
std::int64_t nanoseconds(double s) { return static_cast<std::int64_t>(std::llround(s * 1e9)); }

}  // namespace

class EgoMotion::Impl {
 public:
  Impl(const CameraRig& rig, const ImuCalibration& imu, const EgoMotionOptions& options)
      : rig_(rig),
        options_(options),
        assembler_(rig.size(), options.assembler, timeOffsets(rig)),
        tracker_(rig, options.tracker),
        imu_monitor_(imu.rate_hz, options.inertial.gravity),
        R_body_imu_(imu.T_body_imu.linear()),
        window_(options.window) {
    validate(options);
    options_.inertial.initial_velocity_sigma = options.initial_velocity_sigma;
    if (options.use_imu) {
      auto motion =
          std::make_unique<InertialMotion>(imu, options_.inertial, &imu_buffer_, options.imu_orientation == "message");
      inertial_ = motion.get();
      motion_ = std::move(motion);
    } else {
      motion_ = std::make_unique<ConstantRateMotion>(options.constant_rate_sigma, options.initial_velocity_sigma);
    }
  }

  void addImu(const ImuSample& sample) {
    if (!options_.use_imu) return;
    imu_monitor_.add(sample);
    if (!imu_buffer_.empty() && sample.stamp_ns > 0 &&
        seconds(imu_buffer_.latestStamp() - sample.stamp_ns) > kJumpBack) {
      imu_buffer_.clear();
    }
    imu_buffer_.add(sample);
  }

  void addImage(const CameraImage& image, std::int64_t now_ns) {
    if (image.stamp_ns > 0 && last_stamp_ns_ > 0 && seconds(last_stamp_ns_ - image.stamp_ns) > kJumpBack) {
      timeJump(image.stamp_ns);
    }
    assembler_.add(image, now_ns);
  }

  std::vector<EgoMotionResult> advance(std::int64_t now_ns) {
    now_ns_ = std::max(now_ns_, now_ns);
    for (FrameSet& set : assembler_.advance(now_ns)) pending_.push_back(std::move(set));
    std::vector<EgoMotionResult> results;
    while (!pending_.empty()) {
      const FrameSet& set = pending_.front();
      if (options_.use_imu && imu_buffer_.latestStamp() < inertialStamp(set) &&
          seconds(now_ns - set.stamp_ns) < options_.max_imu_wait_s) {
        break;
      }
      process(set, &results);
      pending_.pop_front();
    }
    if (pending_.empty()) coast(&results);
    return results;
  }

  std::vector<EgoMotionResult> finish() {
    return advance(now_ns_ + nanoseconds(options_.assembler.sync_timeout_s + options_.max_imu_wait_s + 1.0));
  }

  void reset(bool forget_biases, const Eigen::Isometry3d* T_odom_body) {
    restart_pose_.reset();
    if (T_odom_body) restart_pose_ = *T_odom_body;
    forgetMotion(forget_biases);
    drift_ = SystematicDrift();
    ++odom_epoch_;
  }

  std::optional<EgoMotionResult> predictToLatestImu() const {
    if (!inertial_ || !inertial_->initialized() || last_stamp_ns_ == 0 || lost() ||
        imu_buffer_.latestStamp() <= motion_->stamp()) {
      return std::nullopt;
    }
    InertialMotion ahead = *inertial_;
    ahead.advanceTo(imu_buffer_.latestStamp());
    return predicted(ahead, imu_buffer_.latestStamp());
  }

  EgoMotionCounters counters() const {
    EgoMotionCounters counters = counters_;
    const FrameAssemblerCounters& assembler = assembler_.counters();
    counters.rejected_imu = imu_buffer_.faults().total();
    counters.late_images += assembler.late_images;
    counters.rejected_images = assembler.invalid_images + assembler.implausible_stamps + assembler.duplicate_images +
                               tracker_.counters().ignored_images;
    return counters;
  }

  std::vector<std::string> faults() const {
    std::vector<std::string> all = imu_monitor_.faults();
    if (gyroscope_check_.state() == GyroscopeCheck::State::kDisagrees) {
      all.push_back("gyroscope " + gyroscope_check_.report());
    }
    return all;
  }

  CameraRig rig_;
  EgoMotionOptions options_;
  GyroscopeCheck gyroscope_check_;
  FeatureTracker& tracker() { return tracker_; }
  std::function<void(const char*)> observer_;

 private:
  static std::vector<std::int64_t> timeOffsets(const CameraRig& rig) {
    std::vector<std::int64_t> offsets;
    for (const RigCamera& camera : rig.cameras()) offsets.push_back(nanoseconds(camera.time_offset_s));
    return offsets;
  }

  void stage(const char* name) const {
    if (observer_) observer_(name);
  }

  // Reference stamp of a set on the IMU's clock.
  std::int64_t inertialStamp(const FrameSet& set) const {
    return set.stamp_ns + nanoseconds(rig_.camera(set.images.front().camera).time_offset_s);
  }

  // Camera poses in the body at the reference stamp, carried there with the predicted twist (contract 2).
  std::vector<Eigen::Isometry3d> cameraPoses(const FrameSet& set) const {
    const TwistWithCovariance twist = motion_->twist();
    const std::int64_t reference_ns = inertialStamp(set);
    std::vector<Eigen::Isometry3d> poses;
    for (const RigCamera& camera : rig_.cameras()) poses.push_back(camera.T_body_cam);
    for (const CameraImage& image : set.images) {
      const double dt = seconds(image.stamp_ns + nanoseconds(rig_.camera(image.camera).time_offset_s) - reference_ns);
      Eigen::Isometry3d T_reference_image = Eigen::Isometry3d::Identity();
      T_reference_image.linear() = expSO3(twist.angular * dt);
      T_reference_image.translation() = twist.linear * dt;
      poses[image.camera] = T_reference_image * poses[image.camera];
    }
    return poses;
  }

  void process(const FrameSet& set, std::vector<EgoMotionResult>* results) {
    ++counters_.frame_sets;
    results->push_back(newResult(set.stamp_ns));
    EgoMotionResult& result = results->back();
    result.image_stamps_ns.assign(rig_.size(), 0);
    for (const CameraImage& image : set.images) result.image_stamps_ns[image.camera] = image.stamp_ns;

    const std::int64_t stamp_ns = inertialStamp(set);
    if (options_.use_imu && imu_buffer_.latestStamp() < stamp_ns) ++counters_.frame_sets_without_imu;
    if (!motion_->initialized()) {
      if (!motion_->initialize(stamp_ns)) return;
    } else if (stamp_ns <= motion_->stamp()) {
      ++counters_.late_images;
      results->pop_back();
      return;
    } else {
      motion_->advanceTo(stamp_ns);
    }
    imu_buffer_.prune(stamp_ns - nanoseconds(kImuHistory));

    PosedFrame newest;
    newest.T_body_cam = cameraPoses(set);
    const bool first = last_stamp_ns_ == 0;
    const MotionSummary motion = motion_->motionSinceFrame();
    newest.frame = tracker_.track(set, first ? Eigen::Isometry3d::Identity() : motion.T_a_b, newest.T_body_cam);
    newest.frame.stamp_ns = set.stamp_ns;
    stage("tracking");

    if (first) {
      begin(newest, &result);
    } else {
      if (last_period_ns_ == 0 || set.stamp_ns - last_stamp_ns_ < 2 * last_period_ns_) {
        last_period_ns_ = set.stamp_ns - last_stamp_ns_;
      }
      result.previous_stamp_ns = last_stamp_ns_;
      if (!estimate(newest, motion, &result)) bridge(newest, motion, &result);
    }
    motion_->markFrame();
    inertial_last_ns_ = stamp_ns;
    last_stamp_ns_ = set.stamp_ns;
    last_output_ns_ = set.stamp_ns;
    drift_.follow(published_.pose().translation(), tiltVariance());
    fillState(*motion_, &result);
    result.features = reportFeatures(previous_.frame, newest.frame, inlier_tracks_);
    previous_ = std::move(newest);
    stage("frame");
  }

  // First frame of an odom epoch (contract 5).
  void begin(const PosedFrame& newest, EgoMotionResult* result) {
    Eigen::Isometry3d T_odom_body = Eigen::Isometry3d::Identity();
    if (restart_pose_) {
      T_odom_body = *restart_pose_;
    } else {
      T_odom_body.linear() = levelAttitude(motion_->up());
    }
    settled_ = !options_.use_imu;
    epoch_start_ns_ = motion_->stamp();
    last_vision_ns_ = newest.frame.stamp_ns;
    covariance_ = restart_covariance_;
    published_.start(T_odom_body);
    restart_pose_.reset();
    restart_covariance_.setZero();
    startWindow(newest);
    result->keyframe = true;
    result->has_pose = true;
    result->status = EgoMotionStatus::kInitializing;
  }

  void startWindow(const PosedFrame& newest) {
    window_.start(newest.frame.stamp_ns, published_.pose(), covariance_, newest.frame, newest.T_body_cam);
    tracker_.markKeyframe();
  }

  // What most tracks agree on. Where few do with the rotation of the gyroscope and many more without it, the gyroscope
  // is wrong: `motion` then takes the rotation of the images.
  FrameConsensus agreement(const PosedFrame& newest, MotionSummary* motion) const {
    const auto find = [&](const MotionSummary& prior) {
      return findConsensus(previous_, newest, prior, motion_->upAtFrame(), options_.solver, options_.ransac,
                           options_.seed + counters_.frame_sets);
    };
    const FrameConsensus consensus = find(*motion);
    if (!inertial_ || consensus.inliers >= kFewInliers * consensus.correspondences) return consensus;
    MotionSummary doubted = *motion;
    doubted.rotation_covariance += kDoubtedRotation * kDoubtedRotation * Eigen::Matrix3d::Identity();
    const FrameConsensus alone = find(doubted);
    if (!alone.success || alone.inliers < kManyMore * consensus.inliers) return consensus;
    doubted.T_a_b.linear() = alone.T_previous_body.linear();
    *motion = doubted;
    return alone;
  }

  // The check needs the IMU on both sides of the frames and so lags behind.
  void compareWithGyroscope(const Eigen::Matrix3d& R_previous_body) {
    if (!inertial_) return;
    unchecked_.push_back({inertial_last_ns_, motion_->stamp(), R_body_imu_.transpose() * logSO3(R_previous_body)});
    while (!unchecked_.empty() &&
           unchecked_.front().stamp2_ns + nanoseconds(GyroscopeCheck::kLargestOffset) <= imu_buffer_.latestStamp()) {
      const SeenRotation& seen = unchecked_.front();
      gyroscope_check_.add(seen.stamp1_ns, seen.stamp2_ns, seen.rotation, imu_buffer_);
      unchecked_.pop_front();
    }
  }

  bool estimate(const PosedFrame& newest, const MotionSummary& predicted, EgoMotionResult* result) {
    if (window_.empty()) return false;
    MotionSummary motion = predicted;
    const FrameConsensus consensus = agreement(newest, &motion);
    stage("ransac");
    result->solver = consensus.solver;
    result->tracks = consensus.correspondences;
    result->inliers = consensus.inliers;
    result->ransac_samples = consensus.samples;
    if (!consensus.success) return false;
    tracker_.remove(consensus.outliers);

    motion.use_translation = !scale_seen_;
    Eigen::Isometry3d along = consensus.T_previous_body;
    const double speed_sigma = std::sqrt(motion.translation_covariance.trace() / 3.0);
    double distance = motion.T_a_b.translation().norm();
    if (!scale_seen_ && distance < speed_sigma && consensus.parallax_px > kMovingParallax) {
      distance = std::max(distance, kUnknownSpeedShare * speed_sigma);
      motion.T_a_b.translation() = along.translation().normalized() * distance;
    }
    along.translation() = along.translation().normalized() * distance;

    const WindowEstimate estimate = window_.add(without(newest.frame, consensus.outliers), newest.T_body_cam, motion,
                                                {along, motion.T_a_b, consensus.T_previous_body});
    stage("window");
    if (!estimate.ok) return false;
    tracker_.remove(estimate.outliers);
    if (estimate.keyframe) tracker_.markKeyframe();
    inlier_tracks_.clear();
    inlier_tracks_.insert(estimate.inliers.begin(), estimate.inliers.end());

    compareWithGyroscope(estimate.vision.T_a_b.linear());
    learn(estimate, predicted.T_a_b.translation(), consensus.parallax_px);
    if (estimate.scale_state != ScaleState::kNotApplicable) {
      scale_seen_ = estimate.scale_state == ScaleState::kObservable;
    }

    const double dt = seconds(newest.frame.stamp_ns - last_stamp_ns_);
    published_.follow(estimate.T_odom_previous, estimate.T_odom_body, dt);
    if (options_.use_imu) followVertical(estimate.T_odom_body.translation(), dt);
    covariance_ = estimate.covariance;
    result->T_previous_body.pose = estimate.relative.T_a_b;
    result->T_previous_body.covariance = estimate.relative.covariance;
    result->has_relative_pose = result->has_pose = true;
    result->status = settled_ ? EgoMotionStatus::kTracking : EgoMotionStatus::kInitializing;
    result->scale_state = estimate.scale_state;
    result->scale_sigma = estimate.scale_sigma;
    result->pixel_sigma = estimate.pixel_sigma;
    result->keyframe = estimate.keyframe;
    result->points = window_.points();
    last_vision_ns_ = newest.frame.stamp_ns;
    return true;
  }

  // What vision saw goes into the motion model: the displacement where its scale is seen or where nothing moves, else
  // its direction.
  void learn(const WindowEstimate& estimate, const Eigen::Vector3d& predicted, double parallax_px) {
    const bool standing = estimate.scale_state == ScaleState::kNotApplicable;
    RelativeMotion learned = estimate.vision;
    Eigen::Ref<Eigen::Matrix3d> covariance = learned.covariance.topLeftCorner<3, 3>();
    bool use_displacement = true;
    if (standing && !scale_seen_) {
      const double sigma = kFarDistance * std::max(parallax_px, kStillParallax) / rig_.camera(0).model.focalLength();
      learned.T_a_b.translation().setZero();
      covariance = sigma * sigma * Eigen::Matrix3d::Identity();
    } else if (!standing && estimate.scale_state != ScaleState::kObservable) {
      const double seen = learned.T_a_b.translation().norm();
      const Eigen::Vector3d direction = learned.T_a_b.translation() / std::max(seen, 1e-9);
      const double distance = direction.dot(predicted);
      use_displacement = seen > 1e-9 && distance > 0.0;
      const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - direction * direction.transpose();
      learned.T_a_b.translation() = distance * direction;
      covariance = (across * covariance * across * (distance * distance / (seen * seen)) +
                    kUnknownDistance * kUnknownDistance * direction * direction.transpose())
                       .eval();
    }
    motion_->correct(learned, use_displacement);
  }

  // Turns the attitude towards the vertical: at once while it is being found after a start in motion, later slowly
  // (contract 5).
  void followVertical(const Eigen::Vector3d& window_position, double dt) {
    settled_ =
        settled_ || motion_->tiltSigma() < kSettledTilt || seconds(motion_->stamp() - epoch_start_ns_) > kMaxSettling;
    Eigen::Matrix3d turn = tiltCorrection(published_.pose().linear(), motion_->up(), motion_->tiltSigma());
    if (settled_) turn = slowed(turn, options_.max_tilt_correction_rate, dt);
    published_.turn(turn);
    window_.rotateAbout(window_position, turn);
  }

  // Of the published attitude, per axis: what is known of the vertical and how far the attitude is from it. Without an
  // IMU the first attitude says what is up.
  double tiltVariance() const {
    if (!options_.use_imu) return 0.0;
    const Eigen::Vector3d up = published_.pose().linear() * motion_->up();
    const double offset = std::atan2(up.head<2>().norm(), up.z()), sigma = motion_->tiltSigma();
    return sigma * sigma + 0.5 * offset * offset;
  }

  // Vision failed: the pose goes on with the predicted motion, the window starts anew from there.
  void bridge(const PosedFrame& newest, const MotionSummary& motion, EgoMotionResult* result) {
    ++counters_.estimation_failures;
    inlier_tracks_.clear();
    const Matrix6d motion_covariance = poseCovariance(motion);
    covariance_ = propagateCovariance(covariance_, published_.pose(), motion.T_a_b, motion_covariance);
    published_.move(motion.T_a_b);
    startWindow(newest);
    result->T_previous_body = {motion.T_a_b, motion_covariance};
    result->status = coastStatus(newest.frame.stamp_ns);
    result->has_pose = result->has_relative_pose = result->status == EgoMotionStatus::kCoasting;
    result->scale_state = ScaleState::kUnobservable;
    result->scale_sigma = std::numeric_limits<double>::infinity();
    result->keyframe = true;
  }

  // Poses at the nominal rate while no images come (contract 3).
  void coast(std::vector<EgoMotionResult>* results) {
    if (!inertial_ || last_stamp_ns_ == 0) return;
    const std::int64_t period = last_period_ns_ > 0 ? last_period_ns_ : nanoseconds(kDefaultPeriod);
    const std::int64_t wait = period + nanoseconds(options_.assembler.sync_timeout_s + options_.max_imu_wait_s);
    while (imu_buffer_.latestStamp() >= last_output_ns_ + period + wait && !lost()) {
      last_output_ns_ += period;
      if (last_output_ns_ <= motion_->stamp()) continue;
      motion_->advanceTo(last_output_ns_);
      results->push_back(predicted(*motion_, last_output_ns_));
    }
  }

  bool lost() const { return seconds(last_output_ns_ - last_vision_ns_) > options_.max_coast_s; }

  EgoMotionStatus coastStatus(std::int64_t stamp_ns) const {
    return seconds(stamp_ns - last_vision_ns_) > options_.max_coast_s ? EgoMotionStatus::kLost
                                                                      : EgoMotionStatus::kCoasting;
  }

  // The published pose carried on by a motion model that stands at `stamp_ns`.
  EgoMotionResult predicted(const MotionModel& model, std::int64_t stamp_ns) const {
    EgoMotionResult result = newResult(stamp_ns);
    result.previous_stamp_ns = last_stamp_ns_;
    result.status = coastStatus(stamp_ns);
    result.has_pose = result.status == EgoMotionStatus::kCoasting;
    const MotionSummary motion = model.motionSinceFrame();
    const Matrix6d motion_covariance = poseCovariance(motion);
    fillState(model, &result);
    result.T_odom_body.covariance =
        propagateCovariance(result.T_odom_body.covariance, published_.pose(), motion.T_a_b, motion_covariance);
    result.T_odom_body.pose = published_.pose() * motion.T_a_b;
    return result;
  }

  EgoMotionResult newResult(std::int64_t stamp_ns) const {
    EgoMotionResult result;
    result.stamp_ns = stamp_ns;
    result.odom_epoch = odom_epoch_;
    return result;
  }

  void fillState(const MotionModel& model, EgoMotionResult* result) const {
    result->T_odom_body.pose = published_.pose();
    result->T_odom_body.covariance = covariance_ + drift_.covariance();
    result->tilt_sigma = model.tiltSigma();
    for (int axis : {3, 4}) {  // since the last frame, or without an IMU
      double& variance = result->T_odom_body.covariance(axis, axis);
      variance = std::max(variance, result->tilt_sigma * result->tilt_sigma);
    }
    result->twist = model.twist();
    result->gyroscope_bias = model.gyroscopeBias();
    result->accelerometer_bias = model.accelerometerBias();
  }

  static TrackedFrame without(const TrackedFrame& frame, const std::vector<TrackId>& outliers) {
    TrackedFrame kept;
    kept.stamp_ns = frame.stamp_ns;
    for (const FeatureObservation& feature : frame.observations) {
      if (!std::binary_search(outliers.begin(), outliers.end(), feature.track)) kept.observations.push_back(feature);
    }
    return kept;
  }

  // Stamps went back (contract 13).
  void timeJump(std::int64_t stamp_ns) {
    ++counters_.time_jumps;
    if (options_.on_time_jump == "reset") {
      reset(false, nullptr);
      return;
    }
    Matrix6d covariance = covariance_;
    covariance.diagonal().head<3>().array() += kJumpPositionSigma * kJumpPositionSigma;
    covariance.diagonal().tail<3>().array() += kJumpAttitudeSigma * kJumpAttitudeSigma;
    forgetMotion(false);
    restart_pose_ = published_.pose();
    restart_covariance_ = covariance;
    if (inertial_ && stamp_ns > 0) motion_->restartAt(stamp_ns, kJumpAttitudeSigma);
  }

  void forgetMotion(bool forget_biases) {
    assembler_.reset();
    pending_.clear();
    tracker_.reset();
    motion_->reset(forget_biases);
    previous_ = PosedFrame();
    inlier_tracks_.clear();
    unchecked_.clear();
    last_stamp_ns_ = last_output_ns_ = last_vision_ns_ = 0;
    now_ns_ = 0;
    scale_seen_ = false;
    restart_covariance_.setZero();
  }

  FrameAssembler assembler_;
  FeatureTracker tracker_;
  ImuBuffer imu_buffer_;
  ImuMonitor imu_monitor_;
  Eigen::Matrix3d R_body_imu_;
  std::unique_ptr<MotionModel> motion_;
  InertialMotion* inertial_ = nullptr;  ///< motion_ when it is inertial
  Window window_;
  PublishedPose published_;
  Matrix6d covariance_ = Matrix6d::Zero();  ///< of the published pose by the window, odom axes
  SystematicDrift drift_;                   ///< what comes on top

  // Rotation between two frames by the images alone, in the axes of the IMU; stamps of its clock.
  struct SeenRotation {
    std::int64_t stamp1_ns, stamp2_ns;
    Eigen::Vector3d rotation;
  };
  std::deque<SeenRotation> unchecked_;  ///< not yet compared with the gyroscope
  std::int64_t inertial_last_ns_ = 0;   ///< last_stamp_ns_ on the clock of the IMU

  std::deque<FrameSet> pending_;  ///< complete, waiting for the IMU
  PosedFrame previous_;
  std::unordered_set<TrackId> inlier_tracks_;
  std::optional<Eigen::Isometry3d> restart_pose_;
  Matrix6d restart_covariance_ = Matrix6d::Zero();
  bool scale_seen_ = false;
  bool settled_ = false;  ///< the vertical has been found since the start of the odom epoch
  std::int64_t epoch_start_ns_ = 0;
  std::int64_t now_ns_ = 0, last_stamp_ns_ = 0, last_output_ns_ = 0, last_vision_ns_ = 0, last_period_ns_ = 0;
  std::uint32_t odom_epoch_ = 0;
  EgoMotionCounters counters_;
};

EgoMotion::EgoMotion(const CameraRig& rig, const ImuCalibration& imu, const EgoMotionOptions& options)
    : impl_(std::make_unique<Impl>(rig, imu, options)) {}
EgoMotion::~EgoMotion() = default;

void EgoMotion::addImu(const ImuSample& sample) { impl_->addImu(sample); }
void EgoMotion::addImage(const CameraImage& image, std::int64_t now_ns) { impl_->addImage(image, now_ns); }
std::vector<EgoMotionResult> EgoMotion::advance(std::int64_t now_ns) { return impl_->advance(now_ns); }
std::vector<EgoMotionResult> EgoMotion::finish() { return impl_->finish(); }
void EgoMotion::reset(bool forget_biases) { impl_->reset(forget_biases, nullptr); }
void EgoMotion::setPose(const Eigen::Isometry3d& T_odom_body) { impl_->reset(false, &T_odom_body); }
std::optional<EgoMotionResult> EgoMotion::predictToLatestImu() const { return impl_->predictToLatestImu(); }
void EgoMotion::setStageObserver(std::function<void(const char*)> observer) { impl_->observer_ = std::move(observer); }
void EgoMotion::setMask(int camera, const cv::Mat& mask) { impl_->tracker().setMask(camera, mask); }
const CameraRig& EgoMotion::rig() const { return impl_->rig_; }
const EgoMotionOptions& EgoMotion::options() const { return impl_->options_; }
EgoMotionCounters EgoMotion::counters() const { return impl_->counters(); }
std::vector<std::string> EgoMotion::faults() const { return impl_->faults(); }
std::string EgoMotion::gyroscopeCheck() const { return impl_->gyroscope_check_.report(); }

}  // namespace multicam_egomotion
