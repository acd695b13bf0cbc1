// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "multicam_egomotion/odometry/ego_motion.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <deque>
#include <unordered_set>
#include <utility>

#include "multicam_egomotion/geometry/covariance.h"
#include "multicam_egomotion/geometry/so3.h"
#include "multicam_egomotion/imu/gyroscope_check.h"
#include "multicam_egomotion/imu/imu_mounting.h"
#include "multicam_egomotion/odometry/calibrated_rig.h"
#include "multicam_egomotion/odometry/camera_poses.h"
#include "multicam_egomotion/odometry/coasting.h"
#include "multicam_egomotion/odometry/feature_report.h"
#include "multicam_egomotion/odometry/frame_consensus.h"
#include "multicam_egomotion/odometry/learned_motion.h"
#include "multicam_egomotion/odometry/motion_model.h"
#include "multicam_egomotion/odometry/published_pose.h"
#include "multicam_egomotion/odometry/sensor_input.h"
#include "multicam_egomotion/odometry/systematic_drift.h"

namespace multicam_egomotion {
namespace {

constexpr double kMovingParallax = 1.0;        // image motion that shows a translation for certain [px]
constexpr double kUnknownSpeedShare = 0.2;     // of the velocity's sigma, taken for the speed of which nothing is known
constexpr double kJumpPositionSigma = 1.0;     // contract 13 [m]
constexpr double kJumpAttitudeSigma = 0.1745;  // contract 13: 10 deg [rad]
constexpr double kLongOutage = 0.5;            // of all images [s]
constexpr double kWellPredicted = 0.0175;      // sigma of the rotation over an outage: 1 deg [rad]
constexpr double kSureSigmas = 3.0;            // of a predicted displacement that is surely some,
constexpr double kSureDisplacement = 0.02;     // if it is this long as well [m]
constexpr double kSettledTilt = 0.0175;        // sigma of the vertical from which odom is settled: 1 deg [rad]
constexpr double kMaxSettling = 2.0;           // settled after that in any case [s]
constexpr double kFewInliers = 0.5;            // share of the tracks below which the gyroscope may be wrong
constexpr double kManyMore = 1.5;              // times the inliers without the gyroscope, if it is
constexpr double kDoubtedRotation = 0.35;      // sigma of its rotation then [rad]
constexpr double kPoorScale = 0.05;            // sigma of the scale above which its error lasts
constexpr double kContradicted = 6.0;          // accelerometer and images disagree; 3 is what noise makes
constexpr double kSlackSigmas = 6.0;           // of a rotation within which matches are sought; a fault begins at 4
constexpr double kFaultSigmas = 4.0;           // of what the rig file may be wrong by, contract 15
constexpr double kImuHistory = 3.0;            // kept before the newest frame [s]

double seconds(std::int64_t ns) { return 1e-9 * static_cast<double>(ns); }
std::int64_t nanoseconds(double s) { return static_cast<std::int64_t>(std::llround(s * 1e9)); }

}  // namespace

class EgoMotion::Impl {
 public:
  Impl(const CameraRig& rig, const ImuCalibration& imu, const EgoMotionOptions& options)
      : rig_(rig),
        options_(options),
        input_(rig, imu, options),
        tracker_(rig, options.tracker),
        R_body_imu_(imu.T_body_imu.linear()),
        window_(options.window, RigCalibration(rig, options.calibrate_online)),
        coasting_(options.max_coast_s),
        rig_length_sigma_(RigCalibration(rig, options.calibrate_online).lengthSigma()),
        first_camera_(rig.camera(0).T_body_cam.translation()) {
    validate(options);
    options_.inertial.initial_velocity_sigma = options.initial_velocity_sigma;
    if (options.calibrate_online) options_.inertial.length_sigma = rig_length_sigma_;
    if (options.use_imu) {
      auto motion =
          std::make_unique<InertialMotion>(imu, options_.inertial, &input_.imu(), options.imu_orientation == "message",
                                           rig.camera(0).sigmas.time_offset_s, first_camera_);
      inertial_ = motion.get();
      motion_ = std::move(motion);
    } else {
      motion_ = std::make_unique<ConstantRateMotion>(options.constant_rate_sigma, options.initial_velocity_sigma);
    }
  }

  void addImu(const ImuSample& sample) {
    if (input_.addImu(sample)) timeJumpedBack();
  }
  void addImage(const CameraImage& image, std::int64_t now_ns) {
    if (input_.addImage(image, now_ns)) timeJumpedBack();
  }

  std::vector<EgoMotionResult> advance(std::int64_t now_ns) {
    input_.advance(now_ns);
    return processReady();
  }

  std::vector<EgoMotionResult> finish() {
    input_.end();
    return processReady();
  }

  void reset(bool forget_biases, const Eigen::Isometry3d* T_odom_body) {
    input_.forgetImages();
    startEpoch(forget_biases, T_odom_body);
  }

  void tune(const EgoMotionOptions& options) {
    EgoMotionOptions tuned = options_;
    tuned.solver = options.solver;
    tuned.ransac.max_epipolar_error_px = options.ransac.max_epipolar_error_px;
    tuned.tracker.features_per_camera = options.tracker.features_per_camera;
    tuned.tracker.fast_threshold = options.tracker.fast_threshold;
    validate(tuned);
    tracker_.setDetection(tuned.tracker);
    options_ = std::move(tuned);
  }

  std::optional<EgoMotionResult> predictToLatestImu() const {
    if (!inertial_ || !inertial_->initialized() || last_stamp_ns_ == 0 || coasting_.lost() ||
        input_.imu().latestStamp() <= motion_->stamp()) {
      return std::nullopt;
    }
    InertialMotion ahead = *inertial_;
    ahead.advanceTo(input_.imu().latestStamp());
    return predicted(ahead, input_.imu().latestStamp());
  }

  EgoMotionCounters counters() const {
    EgoMotionCounters counters = counters_;
    input_.count(&counters);
    counters.rejected_images += tracker_.counters().ignored_images;
    return counters;
  }

  std::vector<std::string> faults() const {
    std::vector<std::string> all = input_.faults();
    if (gyroscope_check_.state() == GyroscopeCheck::State::kDisagrees) {
      all.push_back("gyroscope " + gyroscope_check_.report());
    }
    if (inertial_ && inertial_->contradiction() > kContradicted) {
      all.push_back(
          "accelerometer disagrees with the images: axes or units of the IMU, T_body_imu or poses of the cameras "
          "wrong?");
    }
    const double length_error = motion_->lengthError();
    if (std::abs(length_error) > kFaultSigmas * options_.inertial.length_sigma && length_error != 0.0) {
      char text[160];
      std::snprintf(
          text, sizeof(text),
          "lengths are %.1f %% off by the accelerometer, expected at most %.1f %%: check the distances between "
          "the cameras, focal lengths and the IMU's units",
          100.0 * length_error, 100.0 * kFaultSigmas * options_.inertial.length_sigma);
      all.push_back(text);
    }
    for (const std::string& fault : calibrationFaults(rig_, calibration())) all.push_back(fault);
    return all;
  }

  std::vector<CameraCalibration> calibration() const {
    std::vector<CameraCalibration> all;
    if (!options_.calibrate_online) return all;
    for (int camera = 0; camera < rig_.size(); ++camera) {
      const CameraCorrection* correction = window_.calibration().correction(camera);
      if (!correction || !correction->turns) continue;
      const Eigen::Matrix3d R_cam_body = rig_.camera(camera).T_body_cam.linear().transpose();
      CameraCalibration one;
      one.camera = camera;
      one.rotation = R_cam_body * logSO3(correction->R);
      one.covariance =
          propagated(R_cam_body, window_.calibrationCovariance().block<3, 3>(correction->column, correction->column));
      one.overlaps = correction->has_field;
      one.focal_length = correction->focal_length;
      one.static_error_px = rmsOverImage(correction->field);
      all.push_back(one);
    }
    return all;
  }

  CameraRig rig_;
  EgoMotionOptions options_;
  GyroscopeCheck gyroscope_check_;
  FeatureTracker& tracker() { return tracker_; }
  std::function<void(const char*)> observer_;

 private:
  void stage(const char* name) const {
    if (observer_) observer_(name);
  }

  std::vector<EgoMotionResult> processReady() {
    std::vector<EgoMotionResult> results;
    while (std::optional<FrameSet> set = input_.next()) process(&*set, &results);
    const double wait = options_.assembler.sync_timeout_s + options_.max_imu_wait_s;
    if (!input_.waiting()) coast(input_.imu().latestStamp() - coasting_.period() - nanoseconds(wait), &results);
    return results;
  }

  void process(FrameSet* set, std::vector<EgoMotionResult>* results) {
    const std::int64_t stamp_ns = input_.inertialStamp(*set);
    if (jumpedAhead(stamp_ns)) goOnAfterJump(seconds(stamp_ns - motion_->stamp()));
    if (last_stamp_ns_ > 0 && coasting_.framesMissingBefore(set->stamp_ns)) {
      coast(set->stamp_ns - coasting_.period() / 2, results);
    }
    ++counters_.frame_sets;
    results->push_back(newResult(set->stamp_ns));
    EgoMotionResult& result = results->back();
    result.image_stamps_ns.assign(rig_.size(), 0);
    for (const CameraImage& image : set->images) result.image_stamps_ns[image.camera] = image.stamp_ns;

    if (options_.use_imu && input_.imu().latestStamp() < stamp_ns) ++counters_.frame_sets_without_imu;
    if (!motion_->initialized()) {
      if (!motion_->initialize(stamp_ns)) return;
    } else if (restart_motion_) {
      motion_->restartAt(stamp_ns, kJumpAttitudeSigma);
    } else if (stamp_ns <= motion_->stamp()) {
      ++counters_.late_images;
      results->pop_back();
      return;
    } else {
      motion_->advanceTo(stamp_ns);
    }
    restart_motion_ = false;
    imu_clock_ns_ = stamp_ns - set->stamp_ns;
    input_.pruneImu(stamp_ns - nanoseconds(kImuHistory));

    const bool first = last_stamp_ns_ == 0;
    const MotionSummary motion = motion_->motionSinceFrame();
    input_.takeOutFrozen(expected(motion, stamp_ns), set);
    if (set->images.empty()) {
      if (first) return;
      result = predicted(*motion_, set->stamp_ns);
      coasting_.markTick(set->stamp_ns);
      return;
    }
    // Patches that have been out of sight for long are found again only roughly: the pose that was coasted is better.
    const bool anew = !first && seconds(set->stamp_ns - last_stamp_ns_) > kLongOutage &&
                      std::sqrt(motion.rotation_covariance.trace() / 3.0) < kWellPredicted;
    if (anew) tracker_.reset();
    bool estimated = true;
    PosedFrame newest;
    std::vector<Eigen::Isometry3d> as_in_file = cameraPoses(rig_, *set, stamp_ns, motion_->twist());
    for (Eigen::Isometry3d& T_body_cam : as_in_file) {
      T_body_cam.translation() = first_camera_ + length_factor_ * (T_body_cam.translation() - first_camera_);
    }
    newest.T_body_cam = corrected(as_in_file);
    newest.turn_sigma_px = turnSigmas();
    std::vector<double> slack_px = newest.turn_sigma_px;
    for (double& slack : slack_px) slack *= kSlackSigmas;
    tracker_.setEpipolarSlack(slack_px);
    newest.frame = tracker_.track(*set, first ? Eigen::Isometry3d::Identity() : motion.T_a_b, newest.T_body_cam);
    newest.frame.stamp_ns = set->stamp_ns;
    stage("tracking");

    if (first) {
      begin(newest, as_in_file, &result);
    } else {
      result.previous_stamp_ns = last_stamp_ns_;
      estimated = !anew && estimate(newest, as_in_file, motion, &result);
      if (!estimated) bridge(newest, as_in_file, motion, &result);
      if (!estimated && !anew) ++counters_.estimation_failures;
    }
    motion_->markFrame();
    inertial_last_ns_ = stamp_ns;
    last_stamp_ns_ = set->stamp_ns;
    coasting_.markFrame(set->stamp_ns, estimated);
    drift_.follow(published_.pose().translation(), tiltVariance(),
                  std::max(lengthSigma(), estimated ? lastingScaleSigma(result) : 0.0));
    fillState(*motion_, &result);
    result.features = reportFeatures(previous_.frame, newest.frame, inlier_tracks_);
    previous_ = std::move(newest);
    stage("frame");
  }

  // The poses of the cameras with what has been learnt of their rotations.
  std::vector<Eigen::Isometry3d> corrected(std::vector<Eigen::Isometry3d> T_body_cam) const {
    for (int camera = 0; camera < rig_.size(); ++camera) {
      const CameraCorrection* correction = window_.calibration().correction(camera);
      if (correction && correction->turns) T_body_cam[camera].linear() = correction->R * T_body_cam[camera].linear();
    }
    return T_body_cam;
  }

  // How far the rotation of each camera, as it is known by now, moves its image [px].
  std::vector<double> turnSigmas() const {
    std::vector<double> sigmas(rig_.size(), 0.0);
    for (const CameraCalibration& one : calibration()) {
      sigmas[one.camera] =
          std::sqrt(one.covariance.diagonal().maxCoeff()) * rig_.camera(one.camera).model.focalLength();
    }
    return sigmas;
  }

  ExpectedMotion expected(const MotionSummary& motion, std::int64_t stamp_ns) const {
    const double displacement = motion.T_a_b.translation().norm();
    ExpectedMotion expected;
    expected.rotation = logSO3(motion.T_a_b.linear());
    expected.rotation_sigma = std::sqrt(motion.rotation_covariance.trace());
    expected.translation = displacement > kSureDisplacement &&
                           displacement > kSureSigmas * std::sqrt(motion.translation_covariance.trace());
    expected.duration_s = seconds(stamp_ns - inertial_last_ns_);
    return expected;
  }

  // First frame of an odom epoch (contract 5).
  void begin(const PosedFrame& newest, const std::vector<Eigen::Isometry3d>& T_body_cam, EgoMotionResult* result) {
    Eigen::Isometry3d T_odom_body = Eigen::Isometry3d::Identity();
    if (restart_pose_) {
      T_odom_body = *restart_pose_;
    } else {
      T_odom_body.linear() = levelAttitude(motion_->up());
    }
    settled_ = !options_.use_imu;
    epoch_start_ns_ = motion_->stamp();
    covariance_ = restart_covariance_;
    published_.start(T_odom_body);
    restart_pose_.reset();
    restart_covariance_.setZero();
    startWindow(newest, T_body_cam);
    result->keyframe = true;
    result->has_pose = true;
    result->status = EgoMotionStatus::kInitializing;
  }

  void startWindow(const PosedFrame& newest, const std::vector<Eigen::Isometry3d>& T_body_cam) {
    window_.start(newest.frame.stamp_ns, published_.pose(), covariance_, newest.frame, T_body_cam);
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
           unchecked_.front().stamp2_ns + nanoseconds(GyroscopeCheck::kLargestOffset) <= input_.imu().latestStamp()) {
      const SeenRotation& seen = unchecked_.front();
      gyroscope_check_.add(seen.stamp1_ns, seen.stamp2_ns, seen.rotation, input_.imu());
      unchecked_.pop_front();
    }
  }

  bool estimate(const PosedFrame& newest, const std::vector<Eigen::Isometry3d>& T_body_cam,
                const MotionSummary& predicted, EgoMotionResult* result) {
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

    motion.use_translation = !scale_seen_ || !inertial_;  // without an IMU nothing else says that bodies have inertia
    Eigen::Isometry3d along = consensus.T_previous_body;
    const double speed_sigma = std::sqrt(motion.translation_covariance.trace() / 3.0);
    double distance = motion.T_a_b.translation().norm();
    if (!scale_seen_ && distance < speed_sigma && consensus.parallax_px > kMovingParallax) {
      distance = std::max(distance, kUnknownSpeedShare * speed_sigma);
      motion.T_a_b.translation() = along.translation().normalized() * distance;
    }
    along.translation() = along.translation().normalized() * distance;

    const WindowEstimate estimate = window_.add(without(newest.frame, consensus.outliers), T_body_cam, motion,
                                                {along, motion.T_a_b, consensus.T_previous_body});
    stage("window");
    if (!estimate.ok) return false;
    tracker_.remove(estimate.outliers);
    if (estimate.keyframe) tracker_.markKeyframe();
    if (rig_.size() > 1) tracker_.resume(window_.unseen(), estimate.relative.T_a_b);
    inlier_tracks_.clear();
    inlier_tracks_.insert(estimate.inliers.begin(), estimate.inliers.end());

    compareWithGyroscope(estimate.vision.T_a_b.linear());
    LearnedMotion learned = learnedMotion(estimate, predicted.T_a_b.translation(), scale_seen_, consensus.parallax_px,
                                          rig_.camera(0).model.focalLength());
    learned.vision = asLongAsInFile(learned.vision);
    motion_->correct(learned.vision, learned.use_displacement);
    if (inertial_) {
      WindowEstimate in_file = estimate;
      in_file.vision = asLongAsInFile(estimate.vision);
      in_file.relative = asLongAsInFile(estimate.relative);
      inertial_->reviseStart(in_file);
    }
    if (estimate.scale_state != ScaleState::kNotApplicable) {
      scale_seen_ = estimate.scale_state == ScaleState::kObservable;
    }

    const double dt = seconds(newest.frame.stamp_ns - last_stamp_ns_);
    published_.follow(estimate.T_odom_previous, estimate.T_odom_body, dt);
    if (options_.use_imu) followVertical(estimate.T_odom_body.translation(), dt);
    followLength();
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
    return true;
  }

  // A motion of the window with the distances between the cameras that the rig file has.
  RelativeMotion asLongAsInFile(RelativeMotion motion) const {
    const Eigen::Vector3d turned = motion.T_a_b.linear() * first_camera_, arm = turned - first_camera_;
    motion.T_a_b.translation() = (motion.T_a_b.translation() + arm) / length_factor_ - arm;
    Matrix6d by_motion = Matrix6d::Identity();
    by_motion.topLeftCorner<3, 3>() /= length_factor_;
    by_motion.topRightCorner<3, 3>() = (1.0 - 1.0 / length_factor_) * skew(turned);
    motion.covariance = propagated(by_motion, motion.covariance);
    return motion;
  }

  // Of all lengths, by what is not known of the rig [1].
  double lengthSigma() const {
    const auto by_accelerometer = motion_->lengthSigma();
    return options_.calibrate_online && by_accelerometer ? *by_accelerometer : rig_length_sigma_;
  }

  // Lengths follow what the accelerometer says of the distances between the cameras.
  void followLength() {
    window_.setLengthSigma(lengthSigma());
    const double factor = 1.0 / (1.0 + motion_->lengthError());
    if (factor == length_factor_) return;
    window_.scale(factor / length_factor_, first_camera_);
    length_factor_ = factor;
  }

  // Turns the attitude towards the vertical: at once while it is being found after a start in motion, later slowly
  // (contract 5).
  void followVertical(const Eigen::Vector3d& window_position, double dt) {
    Eigen::Matrix3d turn = tiltCorrection(published_.pose().linear(), motion_->up(), motion_->tiltSigma());
    if (settled_) turn = slowed(turn, options_.max_tilt_correction_rate, dt);
    published_.turn(turn);
    window_.rotateAbout(window_position, turn);
    settled_ =
        settled_ || motion_->tiltSigma() < kSettledTilt || seconds(motion_->stamp() - epoch_start_ns_) > kMaxSettling;
  }

  // Of the published attitude, per axis: what is known of the vertical and how far the attitude is from it. Without an
  // IMU the first attitude says what is up.
  double tiltVariance() const {
    if (!options_.use_imu) return 0.0;
    const Eigen::Vector3d up = published_.pose().linear() * motion_->up();
    const double offset = std::atan2(up.head<2>().norm(), up.z()), sigma = motion_->tiltSigma();
    return sigma * sigma + 0.5 * offset * offset;
  }

  // Of the length since the last frame, where its error is not another one in each frame: noise in the images shortens
  // what they show, and where they show nothing it is the velocity's.
  static double lastingScaleSigma(const EgoMotionResult& result) {
    if (!result.has_relative_pose || result.scale_state == ScaleState::kNotApplicable) return 0.0;
    double sigma = result.scale_sigma;
    if (result.scale_state == ScaleState::kUnobservable) {
      const Eigen::Vector3d& motion = result.T_previous_body.pose.translation();
      const double variance = motion.dot(result.T_previous_body.covariance.topLeftCorner<3, 3>() * motion);
      sigma = std::sqrt(variance) / std::max(motion.squaredNorm(), 1e-12);
    }
    return sigma < kPoorScale && result.scale_state == ScaleState::kObservable ? 0.0 : std::min(1.0, sigma);
  }

  // Vision failed or starts anew: the pose goes on with the predicted motion, the window starts anew from there.
  void bridge(const PosedFrame& newest, const std::vector<Eigen::Isometry3d>& T_body_cam, const MotionSummary& motion,
              EgoMotionResult* result) {
    inlier_tracks_.clear();
    const Matrix6d motion_covariance = poseCovariance(motion);
    covariance_ = propagateCovariance(covariance_, published_.pose(), motion.T_a_b, motion_covariance);
    published_.move(motion.T_a_b);
    startWindow(newest, T_body_cam);
    result->T_previous_body = {motion.T_a_b, motion_covariance};
    result->status = coasting_.status(newest.frame.stamp_ns);
    result->has_pose = result->has_relative_pose = result->status == EgoMotionStatus::kCoasting;
    result->scale_state = ScaleState::kUnobservable;
    result->scale_sigma = std::numeric_limits<double>::infinity();
    result->keyframe = true;
  }

  // Poses while no images come (contract 3); not across a hole in the IMU data that is too long to coast.
  void coast(std::int64_t until_ns, std::vector<EgoMotionResult>* results) {
    while (const auto tick_ns = inertial_ ? coasting_.nextTick(until_ns) : std::nullopt) {
      const std::int64_t stamp_ns = *tick_ns + imu_clock_ns_;
      if (stamp_ns > motion_->stamp()) {
        if (input_.imu().largestGap(motion_->stamp(), until_ns + imu_clock_ns_) > options_.max_coast_s) return;
        motion_->advanceTo(stamp_ns);
        results->push_back(predicted(*motion_, *tick_ns));
      }
      coasting_.markTick(*tick_ns);
    }
  }

  // The published pose carried on by a motion model that stands at `stamp_ns`.
  EgoMotionResult predicted(const MotionModel& model, std::int64_t stamp_ns) const {
    EgoMotionResult result = newResult(stamp_ns);
    result.previous_stamp_ns = last_stamp_ns_;
    result.status = coasting_.status(stamp_ns);
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
    result->up = model.up();
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

  // Neither images nor IMU for so long that the clock has jumped, or might as well have.
  bool jumpedAhead(std::int64_t stamp_ns) const {
    if (last_stamp_ns_ == 0 || seconds(stamp_ns - motion_->stamp()) <= options_.max_coast_s) return false;
    return !inertial_ || input_.imu().largestGap(motion_->stamp(), stamp_ns) > options_.max_coast_s;
  }

  // Contract 13.
  void timeJumpedBack() {
    if (last_stamp_ns_ == 0) return;
    if (options_.on_time_jump == "continue") {
      goOnAfterJump(0.0);
    } else {
      ++counters_.time_jumps;
      startEpoch(false, nullptr);
    }
  }

  // The pose is kept, with what may have happened meanwhile in its covariance.
  void goOnAfterJump(double unseen_s) {
    ++counters_.time_jumps;
    const double position_sigma = kJumpPositionSigma + unseen_s * motion_->twist().linear.norm();
    restart_pose_ = published_.pose();
    restart_covariance_ = covariance_;
    restart_covariance_.diagonal().head<3>().array() += position_sigma * position_sigma;
    restart_covariance_.diagonal().tail<3>().array() += kJumpAttitudeSigma * kJumpAttitudeSigma;
    restart_motion_ = true;
    forgetTracks();
  }

  void startEpoch(bool forget_biases, const Eigen::Isometry3d* T_odom_body) {
    forgetTracks();
    motion_->reset(forget_biases);
    restart_motion_ = false;
    restart_pose_.reset();
    if (T_odom_body) restart_pose_ = *T_odom_body;
    restart_covariance_.setZero();
    drift_ = SystematicDrift();
    ++odom_epoch_;
  }

  void forgetTracks() {
    tracker_.reset();
    previous_ = PosedFrame();
    inlier_tracks_.clear();
    unchecked_.clear();
    coasting_.reset();
    last_stamp_ns_ = 0;
    scale_seen_ = false;
  }

  SensorInput input_;
  FeatureTracker tracker_;
  Eigen::Matrix3d R_body_imu_;
  std::unique_ptr<MotionModel> motion_;
  InertialMotion* inertial_ = nullptr;  ///< motion_ when it is inertial
  Window window_;
  Coasting coasting_;
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

  PosedFrame previous_;
  std::unordered_set<TrackId> inlier_tracks_;
  std::optional<Eigen::Isometry3d> restart_pose_;
  Matrix6d restart_covariance_ = Matrix6d::Zero();
  bool restart_motion_ = false;   ///< at the next frame, after a jump of the clock
  double rig_length_sigma_;       ///< of all lengths, by the rig file [1]
  Eigen::Vector3d first_camera_;  ///< its centre in the body [m]
  double length_factor_ = 1.0;    ///< the distances between the cameras are this many times those of the rig file
  bool scale_seen_ = false;
  bool settled_ = false;  ///< the vertical has been found since the start of the odom epoch
  std::int64_t epoch_start_ns_ = 0;
  std::int64_t last_stamp_ns_ = 0;
  std::int64_t imu_clock_ns_ = 0;  ///< of the IMU against the reference stamps
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
void EgoMotion::tune(const EgoMotionOptions& options) { impl_->tune(options); }
const CameraRig& EgoMotion::rig() const { return impl_->rig_; }
const EgoMotionOptions& EgoMotion::options() const { return impl_->options_; }
EgoMotionCounters EgoMotion::counters() const { return impl_->counters(); }
std::vector<std::string> EgoMotion::faults() const { return impl_->faults(); }
std::vector<CameraCalibration> EgoMotion::calibration() const { return impl_->calibration(); }
std::string EgoMotion::gyroscopeCheck() const { return impl_->gyroscope_check_.report(); }

}  // namespace multicam_egomotion
