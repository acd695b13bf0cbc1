// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "multicam_egomotion/odometry/window.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "multicam_egomotion/geometry/covariance.h"
#include "multicam_egomotion/geometry/so3.h"
#include "multicam_egomotion/odometry/landmark_distance.h"
#include "multicam_egomotion/odometry/window_marginals.h"
#include "multicam_egomotion/odometry/window_scale.h"

namespace multicam_egomotion {
namespace {

constexpr double kDoubtedRotation = 0.35;  // sigma of a prior that the images contradict [rad]
constexpr double kMovingSigmas = 5.0;      // error of a track at a pose found without it
constexpr int kManyKnown = 60;             // landmarks that do without newcomers
constexpr int kFramesOfNewcomers = 3;
constexpr double kRestParallax = 0.5;  // between two frames [px]
constexpr int kFewLandmarks = 20;      // seen on both sides of a motion, below which its prediction counts as well
constexpr double kFlatScale = 0.05;    // of the relative decrease of the cost at which an adjustment ends
constexpr int kMinLandmarks = 6;       // tracks that the newest frame shares with older ones, below which it fails

BundlePose toBundle(const Eigen::Isometry3d& T) { return {T.linear(), T.translation()}; }

Eigen::Isometry3d toIsometry(const BundlePose& pose) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = pose.R;
  T.translation() = pose.p;
  return T;
}

}  // namespace

Window::Window(const WindowOptions& options, const RigCalibration& calibration)
    : options_(options),
      rig_calibration_(calibration),
      calibration_(calibration.prior().calibration),
      calibration_covariance_(calibration.priorCovariance()),
      length_sigma_(calibration.lengthSigma()),
      noise_(options.initial_pixel_sigma, options.min_pixel_sigma, options.max_pixel_sigma) {}

void Window::start(std::int64_t stamp_ns, const Eigen::Isometry3d& T_odom_body, const Matrix6d& covariance,
                   const TrackedFrame& frame, const std::vector<Eigen::Isometry3d>& T_body_cam) {
  const BundlePrior known = calibrationAlone();
  landmarks_.clear();
  states_.assign(1, State());
  states_[0].stamp_ns = stamp_ns;
  states_[0].pose = toBundle(T_odom_body);
  states_[0].keyframe = true;
  start_ = {T_odom_body, covariance};
  prior_.poses = {0};
  prior_.linearization = {states_[0].pose};
  const int unknowns = known.calibration.size();
  prior_.calibration = known.calibration;
  prior_.H = Eigen::MatrixXd::Zero(6 + unknowns, 6 + unknowns);
  prior_.H.topLeftCorner<6, 6>() = 1e8 * Matrix6d::Identity();
  prior_.H.bottomRightCorner(unknowns, unknowns) = known.H;
  prior_.b = Eigen::VectorXd::Zero(6 + unknowns);
  prior_.b.tail(unknowns) = known.b;
  addObservations(frame, T_body_cam);
}

// What is known of the calibration by everything that the window has seen.
BundlePrior Window::calibrationAlone() const {
  if (states_.empty() || calibration_.size() == 0) return rig_calibration_.prior();
  std::vector<TrackId> tracks;
  BundleAdjustment bundle = makeBundle(&tracks);
  return marginalizeFirstPoses(static_cast<int>(states_.size()), &bundle, options_.bundle);
}

void Window::addObservations(const TrackedFrame& frame, const std::vector<Eigen::Isometry3d>& T_body_cam) {
  const int newest = static_cast<int>(states_.size()) - 1;
  const BundlePose& pose = states_[newest].pose;
  for (const FeatureObservation& feature : frame.observations) {
    const Eigen::Isometry3d& T = T_body_cam[feature.camera];
    BundleObservation observation;
    observation.pose = newest;
    observation.camera = feature.camera;
    observation.bearing = T.linear() * feature.bearing;
    observation.center = T.translation();
    observation.to_pixel = feature.to_pixel * T.linear().transpose();
    rig_calibration_.place(feature, T, &observation);
    Landmark& landmark = landmarks_[feature.track];
    if (landmark.observations.empty()) {
      landmark.origin = pose.p + pose.R * observation.center;
      landmark.direction = pose.R * observation.bearing;
      landmark.inverse_distance = 0.0;
    }
    landmark.frames += landmark.observations.empty() || landmark.observations.back().pose != newest;
    landmark.observations.push_back(observation);
  }
}

void Window::initializeLandmarks() {
  BundleAdjustment errors;
  for (const State& state : states_) errors.poses.push_back(state.pose);
  errors.calibration = calibration_;
  errors.pixel_sigma = noise_.pixelSigma();
  for (auto& [track, landmark] : landmarks_) {
    if (landmark.inverse_distance != 0.0 || landmark.observations.size() < 2) continue;
    landmark.inverse_distance = findInverseDistance(landmark, errors);
  }
}

// How many landmarks are seen both before and after each motion between states, by its later state.
std::vector<int> Window::landmarksAcross() const {
  std::vector<int> across(states_.size() + 1, 0);
  for (const auto& [track, landmark] : landmarks_) {
    ++across[landmark.observations.front().pose + 1];
    --across[landmark.observations.back().pose + 1];
  }
  std::partial_sum(across.begin(), across.end(), across.begin());
  return across;
}

BundleAdjustment Window::makeBundle(std::vector<TrackId>* tracks) const {
  BundleAdjustment bundle;
  const std::vector<int> across = landmarksAcross();
  for (std::size_t i = 0; i < states_.size(); ++i) {
    bundle.poses.push_back(states_[i].pose);
    if (i == 0) continue;
    const MotionSummary& motion = states_[i].from_previous;
    MotionFactor factor;
    factor.pose_a = static_cast<int>(i) - 1;
    factor.pose_b = static_cast<int>(i);
    factor.R_a_b = motion.T_a_b.linear();
    factor.rotation_information = symmetricInverse(motion.rotation_covariance);
    factor.p_b_a = motion.T_a_b.translation();
    if (motion.use_translation || across[i] < kFewLandmarks) {
      factor.translation_information = symmetricInverse(motion.translation_covariance);
    }
    bundle.factors.push_back(factor);
  }
  for (const auto& [track, landmark] : landmarks_) {
    if (landmark.observations.size() < 2) continue;
    const bool newcomer = landmark.frames < kFramesOfNewcomers && !states_[landmark.observations.front().pose].keyframe;
    if (newcomers_wait_ && newcomer) continue;
    tracks->push_back(track);
    bundle.landmarks.push_back(landmark);
  }
  bundle.prior = prior_;
  bundle.calibration = calibration_;
  bundle.pixel_sigma = noise_.pixelSigma();
  bundle.offset_sigma = noise_.offsetSigma();
  return bundle;
}

// The newest pose alone, refined against the landmarks as they are from each guess of the motion; the one that fits
// best.
BundlePose Window::alignedNewest(const std::vector<Eigen::Isometry3d>& guesses) const {
  const int newest = static_cast<int>(states_.size()) - 1;
  BundleAdjustment bundle;
  bundle.calibration = calibration_;
  bundle.pixel_sigma = noise_.pixelSigma();
  int views = 0;
  for (const auto& [track, landmark] : landmarks_) {
    if (landmark.inverse_distance == 0.0 || landmark.observations.front().pose == newest) continue;
    BundleLandmark seen;
    seen.origin = landmark.origin;
    seen.direction = landmark.direction;
    seen.inverse_distance = landmark.inverse_distance;
    seen.offsets = landmark.offsets;
    for (const BundleObservation& observation : landmark.observations) {
      if (observation.pose != newest) continue;
      seen.observations.push_back(observation);
      seen.observations.back().pose = 0;
      ++views;
    }
    bundle.landmarks.push_back(std::move(seen));
  }
  const Eigen::Isometry3d T_odom_previous = toIsometry(states_[newest - 1].pose);
  const bool enough = views >= kMinLandmarks;
  BundleOptions options = options_.bundle;
  options.fix_landmarks = true;
  double best_cost = std::numeric_limits<double>::infinity();
  BundlePose best = states_.back().pose;
  for (const Eigen::Isometry3d& guess : guesses) {
    bundle.poses = {toBundle(T_odom_previous * guess)};
    const double cost = enough ? bundle.solve(options).cost : 0.0;
    if (cost < best_cost) {
      best_cost = cost;
      best = bundle.poses[0];
    }
  }
  return best;
}

WindowEstimate Window::add(const TrackedFrame& frame, const std::vector<Eigen::Isometry3d>& T_body_cam,
                           const MotionSummary& motion, const std::vector<Eigen::Isometry3d>& guesses) {
  WindowEstimate estimate;
  int shared = 0;
  TrackId last = 0;
  for (const FeatureObservation& feature : frame.observations) {
    if (feature.track == last) continue;
    last = feature.track;
    shared += landmarks_.count(feature.track) ? 1 : 0;
  }
  if (shared < kMinLandmarks) return estimate;

  // The frame before the previous one goes unless it was a keyframe.
  const int previous = static_cast<int>(states_.size()) - 1;
  if (previous >= 1 && !states_[previous - 1].keyframe) dropState(previous - 1);

  initializeLandmarks();
  State state;
  state.stamp_ns = frame.stamp_ns;
  state.from_previous = motion;
  state.pose = toBundle(toIsometry(states_.back().pose) * motion.T_a_b);
  states_.push_back(state);
  addObservations(frame, T_body_cam);

  states_.back().pose = alignedNewest(guesses);
  newcomers_wait_ = seemsAtRest();
  initializeLandmarks();
  if (newcomers_wait_) dropMoving(&estimate);

  optimize(&estimate);
  return estimate;
}

// The known landmarks say that the body has hardly moved.
bool Window::seemsAtRest() const {
  const BundlePose& previous = states_[states_.size() - 2].pose;
  const BundlePose& newest = states_.back().pose;
  std::vector<double> parallax;
  int known = 0;
  for (const auto& [track, landmark] : landmarks_) {
    if (landmark.inverse_distance == 0.0 || !seenInNewest(landmark)) continue;
    ++known;
    if (errorInNewest(landmark) > options_.outlier_sigmas) continue;
    const BundleObservation& view = landmark.observations.back();
    const Eigen::Vector3d moved =
        newest.R.transpose() * (previous.p + previous.R * view.center - newest.p) - view.center;
    parallax.push_back((view.to_pixel * moved).norm() * landmark.inverse_distance);
  }
  if (static_cast<int>(parallax.size()) < std::max(kManyKnown, known / 2)) return false;
  const auto middle = parallax.begin() + parallax.size() / 2;
  std::nth_element(parallax.begin(), middle, parallax.end());
  return *middle < kRestParallax;
}

// Tracks of a moving object that passes along the epipolar lines fit a motion of the body that is not, as long as their
// distances are free: they are judged by the pose that the known landmarks give.
void Window::dropMoving(WindowEstimate* estimate) {
  for (auto it = landmarks_.begin(); it != landmarks_.end();) {
    const bool moving =
        it->second.observations.size() >= 2 && seenInNewest(it->second) && errorInNewest(it->second) > kMovingSigmas;
    if (moving) estimate->outliers.push_back(it->first);
    it = moving ? landmarks_.erase(it) : std::next(it);
  }
}

bool Window::seenInNewest(const BundleLandmark& landmark) const {
  return landmark.observations.back().pose == static_cast<int>(states_.size()) - 1;
}

double Window::errorInNewest(const BundleLandmark& landmark) const {
  BundleAdjustment bundle;
  bundle.pixel_sigma = noise_.pixelSigma();
  bundle.calibration = calibration_;
  bundle.poses = {states_.back().pose};
  BundleObservation view = landmark.observations.back();
  view.pose = 0;
  const double error = bundle.normalizedError(landmark, view);
  return error < 0.0 ? std::numeric_limits<double>::infinity() : error;
}

void Window::optimize(WindowEstimate* estimate) {
  const ImageNoise noise = noise_;
  if (!solve(estimate)) return;
  if (contradicted(states_.back().from_previous, estimate->vision)) {
    noise_ = noise;  // without what the wrong prior made of it
    states_.back().from_previous.rotation_covariance +=
        kDoubtedRotation * kDoubtedRotation * Eigen::Matrix3d::Identity();
    if (!solve(estimate)) return;
  }
  classify(estimate);
  estimate->keyframe = wantsKeyframe(estimate);
  if (!estimate->keyframe) return;

  states_.back().keyframe = true;
  // The previous frame served the estimate between frames; between keyframes it is not needed.
  const int previous = static_cast<int>(states_.size()) - 2;
  if (!states_[previous].keyframe) dropState(previous);
  if (static_cast<int>(states_.size()) > options_.max_keyframes) marginalizeOldest();
}

// The joint estimate, without consequences for the tracks.
bool Window::solve(WindowEstimate* estimate) {
  std::vector<TrackId> tracks;
  BundleAdjustment bundle = makeBundle(&tracks);
  BundleOptions options = options_.bundle;
  // Along a scale that overlap does not show the cost is so flat that small steps are still far from the end.
  if (!overlapShowsScale(bundle)) options.relative_decrease *= kFlatScale;
  BundleSummary summary = bundle.solve(options);
  if (!summary.finite) return false;
  const bool from_the_start = prior_.poses.size() == 1;  // nothing has been marginalized
  if (from_the_start && !newcomers_wait_) findScale(options, &bundle, &summary);
  estimate->lengthening *= lengthening(bundle);
  for (std::size_t i = 0; i < states_.size(); ++i) states_[i].pose = bundle.poses[i];
  calibration_ = bundle.calibration;
  for (std::size_t l = 0; l < tracks.size(); ++l) {
    BundleLandmark& landmark = landmarks_[tracks[l]];
    landmark.origin = bundle.landmarks[l].origin;
    landmark.direction = bundle.landmarks[l].direction;
    landmark.inverse_distance = bundle.landmarks[l].inverse_distance;
    landmark.offsets = bundle.landmarks[l].offsets;
  }
  noise_.measure(bundle, summary, options_.bundle.robust_width);
  const int newest = static_cast<int>(states_.size()) - 1;
  estimate->ok = true;
  estimate->T_odom_previous = toIsometry(states_[newest - 1].pose);
  estimate->T_odom_body = toIsometry(states_[newest].pose);
  estimate->pixel_sigma = noise_.pixelSigma();
  computeMarginals(&bundle, options_.bundle, noise_.whiteShare(), length_sigma_, rig_calibration_.consideredVariances(),
                   estimate);
  calibration_covariance_ = estimate->calibration_covariance;
  // All moves with the start.
  Matrix6d with_start = Matrix6d::Identity();
  with_start.topRightCorner<3, 3>() = -skew(states_[newest].pose.p - start_.T_a_b.translation());
  estimate->covariance += propagated(with_start, start_.covariance);
  return true;
}

// Of the motions between the states before the newest by their new poses.
double Window::lengthening(const BundleAdjustment& bundle) const {
  double common = 0.0, before = 0.0;
  for (std::size_t i = 1; i + 1 < states_.size(); ++i) {
    const Eigen::Vector3d p = states_[i - 1].pose.R.transpose() * (states_[i].pose.p - states_[i - 1].pose.p);
    const BundlePose& a = bundle.poses[i - 1];
    common += p.dot(a.R.transpose() * (bundle.poses[i].p - a.p));
    before += p.squaredNorm();
  }
  return common > 0.0 ? common / before : 1.0;
}

// Splits the tracks of the newest frame by their errors there, and forgets what disagrees.
void Window::classify(WindowEstimate* estimate) {
  BundleAdjustment errors;
  for (const State& state : states_) errors.poses.push_back(state.pose);
  errors.calibration = calibration_;
  errors.pixel_sigma = noise_.pixelSigma();
  const int newest = static_cast<int>(states_.size()) - 1;
  for (auto it = landmarks_.begin(); it != landmarks_.end();) {
    BundleLandmark& landmark = it->second;
    bool in_newest = false, bad = landmark.inverse_distance * options_.min_distance > 1.0;
    for (const Eigen::Vector2d& offset : landmark.offsets) {
      bad = bad || offset.norm() > options_.outlier_sigmas * noise_.offsetSigma();
    }
    for (const BundleObservation& observation : landmark.observations) {
      in_newest = in_newest || observation.pose == newest;
      if (landmark.observations.size() < 2) continue;
      const double error = errors.normalizedError(landmark, observation);
      bad = bad || error < 0.0 || error > options_.outlier_sigmas;
    }
    if (in_newest) (bad ? estimate->outliers : estimate->inliers).push_back(it->first);
    it = bad ? landmarks_.erase(it) : std::next(it);
  }
}

bool Window::wantsKeyframe(WindowEstimate* estimate) const {
  const int newest = static_cast<int>(states_.size()) - 1;
  int keyframe = newest - 1;
  while (keyframe > 0 && !states_[keyframe].keyframe) --keyframe;
  const Eigen::Matrix3d R = states_[keyframe].pose.R.transpose() * states_[newest].pose.R;  // newest into keyframe
  std::vector<double> parallax;
  int seen = 0;
  for (const auto& [track, landmark] : landmarks_) {
    const BundleObservation* then = nullptr;
    const BundleObservation* now = nullptr;
    for (const BundleObservation& observation : landmark.observations) {
      if (observation.pose == newest && !now) now = &observation;
      if (observation.pose == keyframe && !then) then = &observation;
    }
    if (!now) continue;
    ++seen;
    if (!then) continue;
    const Eigen::Vector3d x = R.transpose() * then->bearing;
    const double depth = now->bearing.dot(x);
    if (depth > 0.1) parallax.push_back((now->to_pixel * x).norm() / depth);
  }
  if (parallax.empty()) return true;
  const auto middle = parallax.begin() + parallax.size() / 2;
  std::nth_element(parallax.begin(), middle, parallax.end());
  estimate->parallax_px = *middle;
  return *middle > options_.keyframe_parallax_px || parallax.size() < options_.keyframe_min_shared * seen;
}

// Forgets a state that is no keyframe, with its observations.
void Window::dropState(int index) {
  if (index + 1 < static_cast<int>(states_.size()) && index > 0) {
    states_[index + 1].from_previous = compose(states_[index].from_previous, states_[index + 1].from_previous);
  }
  states_.erase(states_.begin() + index);
  for (auto it = landmarks_.begin(); it != landmarks_.end();) {
    std::vector<BundleObservation>& views = it->second.observations;
    views.erase(std::remove_if(views.begin(), views.end(), [&](const auto& view) { return view.pose == index; }),
                views.end());
    for (BundleObservation& view : views) view.pose -= view.pose > index ? 1 : 0;
    it = views.empty() ? landmarks_.erase(it) : std::next(it);
  }
  for (int& pose : prior_.poses) pose -= pose > index ? 1 : 0;
}

// Turns what is known through the oldest keyframe into a prior on the others. The newest state's views stay with their
// tracks, which start again there.
void Window::marginalizeOldest() {
  const int newest = static_cast<int>(states_.size()) - 1;
  std::vector<TrackId> all;
  BundleAdjustment bundle = makeBundle(&all);
  bundle.landmarks.clear();
  bundle.factors.resize(1);  // from the oldest to the next
  for (auto& [track, landmark] : landmarks_) {
    if (landmark.observations.front().pose != 0) continue;
    BundleLandmark leaving = landmark;
    auto& old_views = leaving.observations;
    old_views.erase(
        std::remove_if(old_views.begin(), old_views.end(), [&](const auto& view) { return view.pose == newest; }),
        old_views.end());
    landmark.offsets = BundleLandmark::noOffsets();
    auto& kept = landmark.observations;
    kept.erase(std::remove_if(kept.begin(), kept.end(), [&](const auto& view) { return view.pose != newest; }),
               kept.end());
    if (old_views.back().pose > 0) bundle.landmarks.push_back(leaving);
  }
  prior_ = marginalizeFirstPoses(1, &bundle, options_.bundle);
  dropState(0);
}

void Window::rotateAbout(const Eigen::Vector3d& pivot, const Eigen::Matrix3d& R) {
  const auto turn = [&](BundlePose* pose) {
    pose->p = pivot + R * (pose->p - pivot);
    pose->R = R * pose->R;
  };
  for (State& state : states_) turn(&state.pose);
  for (BundlePose& pose : prior_.linearization) turn(&pose);
  start_.T_a_b.translation() = pivot + R * (start_.T_a_b.translation() - pivot);
  for (auto& [track, landmark] : landmarks_) {
    landmark.origin = pivot + R * (landmark.origin - pivot);
    landmark.direction = R * landmark.direction;
  }
}

void Window::scale(double factor, const Eigen::Vector3d& first_camera) {
  // Everything is scaled about the first camera of the newest state, and then moved so that its body stays.
  const BundlePose newest = states_.back().pose;
  const Eigen::Vector3d fixed = newest.p + newest.R * first_camera;
  const auto scaled = [&](const Eigen::Vector3d& point) { return Eigen::Vector3d(fixed + factor * (point - fixed)); };
  const auto move = [&](BundlePose* pose) {
    const Eigen::Vector3d arm = pose->R * first_camera;
    pose->p = scaled(pose->p + arm) - arm;
  };
  for (State& state : states_) move(&state.pose);
  for (BundlePose& pose : prior_.linearization) move(&pose);
  BundlePose start{start_.T_a_b.linear(), start_.T_a_b.translation()};
  move(&start);
  start_.T_a_b.translation() = start.p;
  for (auto& [track, landmark] : landmarks_) {
    landmark.origin = scaled(landmark.origin);
    landmark.inverse_distance /= factor;
    for (BundleObservation& view : landmark.observations) {
      view.center = first_camera + factor * (view.center - first_camera);
    }
  }
  // The prior's differences d become T d.
  Matrix6d T_inverse = Matrix6d::Identity();
  T_inverse.topLeftCorner<3, 3>() /= factor;
  T_inverse.topRightCorner<3, 3>() = (factor - 1.0) / factor * skew(first_camera);
  Eigen::MatrixXd all_inverse = Eigen::MatrixXd::Identity(prior_.b.size(), prior_.b.size());
  for (std::size_t i = 0; i < prior_.poses.size(); ++i) all_inverse.block<6, 6>(6 * i, 6 * i) = T_inverse;
  prior_.H = all_inverse.transpose() * prior_.H * all_inverse;
  prior_.b = all_inverse.transpose() * prior_.b;
}

// To better than 20 %, by the parallax that the views have among themselves, against the image noise.
bool Window::distanceIsKnown(const BundleLandmark& landmark) const {
  if (landmark.observations.size() < 2 || landmark.inverse_distance <= 0.0) return false;
  double parallax_px = 0.0;
  const BundlePose& first = states_[landmark.observations.front().pose].pose;
  const Eigen::Vector3d start = first.p + first.R * landmark.observations.front().center;
  for (const BundleObservation& view : landmark.observations) {
    const BundlePose& pose = states_[view.pose].pose;
    const Eigen::Vector3d baseline = pose.R.transpose() * (pose.p + pose.R * view.center - start);
    parallax_px = std::max(parallax_px, (view.to_pixel * baseline).norm() * landmark.inverse_distance);
  }
  return parallax_px > 5.0 * noise_.pixelSigma();
}

std::vector<Eigen::Vector3d> Window::points() const {
  std::vector<Eigen::Vector3d> points;
  for (const auto& [track, landmark] : landmarks_) {
    if (distanceIsKnown(landmark)) points.push_back(landmark.origin + landmark.direction / landmark.inverse_distance);
  }
  return points;
}

std::vector<TrackedPoint> Window::unseen() const {
  std::vector<TrackedPoint> points;
  const BundlePose& newest = states_.back().pose;
  for (const auto& [track, landmark] : landmarks_) {
    if (seenInNewest(landmark) || !distanceIsKnown(landmark)) continue;
    const Eigen::Vector3d position = landmark.origin + landmark.direction / landmark.inverse_distance;
    points.push_back({track, newest.R.transpose() * (position - newest.p)});
  }
  return points;
}

}  // namespace multicam_egomotion
