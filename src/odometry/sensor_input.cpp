// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "multicam_egomotion/odometry/sensor_input.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

namespace multicam_egomotion {
namespace {

constexpr double kJumpBack = 0.5;  // images whose stamps go back by more tell a jump of the clock by themselves [s]
constexpr double kImagesFarBehind = 5.0;  // the IMU, where no buffer keeps its samples that long [s]

double seconds(std::int64_t ns) { return 1e-9 * static_cast<double>(ns); }

// 0, as of a stamp that was never set, for what can be no time.
std::int64_t knownStamp(std::int64_t stamp_ns) { return stamp_ns > 0 && stamp_ns <= kLatestStamp ? stamp_ns : 0; }

std::vector<std::int64_t> timeOffsets(const CameraRig& rig) {
  std::vector<std::int64_t> offsets;
  for (const RigCamera& camera : rig.cameras()) offsets.push_back(std::llround(camera.time_offset_s * 1e9));
  return offsets;
}

}  // namespace

SensorInput::SensorInput(const CameraRig& rig, const ImuCalibration& imu, const EgoMotionOptions& options)
    : rig_(rig),
      use_imu_(options.use_imu),
      max_imu_wait_s_(options.max_imu_wait_s),
      assembler_(rig.size(), options.assembler, timeOffsets(rig)),
      image_monitor_(rig),
      imu_monitor_(imu.rate_hz, options.inertial.gravity),
      latest_image_ns_(rig.size(), 0) {}

bool SensorInput::addImu(const ImuSample& received) {
  if (!use_imu_) return false;
  ImuSample sample = received;
  sample.stamp_ns = knownStamp(sample.stamp_ns);
  imu_monitor_.add(sample);
  bool jumped = false;
  for (const ImuSample& passed : imu_gate_.pass(sample)) {
    if (imu_gate_.jumpedBack() && passed.stamp_ns < imu_buffer_.latestStamp()) {
      imu_buffer_.clear();
      // The images may have told already.
      const std::int64_t latest_ns = *std::max_element(latest_image_ns_.begin(), latest_image_ns_.end());
      jumped = seconds(latest_ns - passed.stamp_ns) > ImuStampGate::kFarBack;
      if (jumped) forgetOtherTime();
    }
    if (imu_buffer_.add(passed)) newest_ns_ = std::max(newest_ns_, passed.stamp_ns);
  }
  return jumped;
}

bool SensorInput::addImage(const CameraImage& received, std::int64_t now_ns) {
  CameraImage image = received;
  image.stamp_ns = knownStamp(image.stamp_ns);
  if (!image_monitor_.fits(image)) return false;
  const bool jumped = wentBack(image);
  if (jumped) {
    forgetOtherTime();
    imu_buffer_.clear();
    newest_ns_ = image.stamp_ns;
  }
  const std::uint64_t refused = assembler_.counters().implausible_stamps;
  assembler_.add(image, dataTime(now_ns));
  if (image.camera >= 0 && image.camera < rig_.size() && assembler_.counters().implausible_stamps == refused) {
    latest_image_ns_[image.camera] = std::max(latest_image_ns_[image.camera], image.stamp_ns);
    newest_ns_ = std::max(newest_ns_, image.stamp_ns);
  }
  return jumped;
}

// Far behind its camera's latest, as the image before it, of whichever camera, or the newest IMU sample: the clock has
// jumped, not one camera or one stamp gone wrong.
bool SensorInput::wentBack(const CameraImage& image) {
  if (image.stamp_ns <= 0 || image.camera < 0 || image.camera >= rig_.size()) return false;
  const double back_s = seconds(latest_image_ns_[image.camera] - image.stamp_ns);
  const bool another = std::exchange(image_went_back_, back_s > kJumpBack);
  return (another && back_s > kJumpBack) || (imu_gate_.waitsBehind() && back_s > ImuStampGate::kFarBack);
}

void SensorInput::forgetOtherTime() {
  forgetImages();
  caller_ahead_ = true;
}

// The caller's time, but that of the data until it has followed a jump back.
std::int64_t SensorInput::dataTime(std::int64_t now_ns) {
  now_ns = std::clamp<std::int64_t>(now_ns, 0, kLatestStamp);
  caller_ahead_ = caller_ahead_ && now_ns > newest_ns_;
  return caller_ahead_ ? newest_ns_ : now_ns;
}

void SensorInput::advance(std::int64_t now_ns) {
  now_ns_ = std::max(now_ns_, dataTime(now_ns));
  for (FrameSet& set : assembler_.advance(now_ns_)) pending_.push_back(std::move(set));
}

void SensorInput::end() {
  caller_ahead_ = false;
  constexpr std::int64_t kLongAfter = 3600000000000;  // all waits are shorter [ns]
  advance(now_ns_ + kLongAfter);
}

std::optional<FrameSet> SensorInput::next() {
  if (pending_.empty()) return std::nullopt;
  const FrameSet& front = pending_.front();
  const bool reached = !use_imu_ || imu_buffer_.latestStamp() >= inertialStamp(front);
  if (!reached && seconds(now_ns_ - front.stamp_ns) < max_imu_wait_s_) return std::nullopt;
  FrameSet set = std::move(pending_.front());
  pending_.pop_front();
  return set;
}

std::int64_t SensorInput::inertialStamp(const FrameSet& set) const {
  return set.stamp_ns + std::llround(rig_.camera(set.images.front().camera).time_offset_s * 1e9);
}

void SensorInput::forgetImages() {
  assembler_.reset();
  image_monitor_.reset();
  pending_.clear();
  latest_image_ns_.assign(rig_.size(), 0);
  image_went_back_ = false;
  now_ns_ = newest_ns_ = 0;
  caller_ahead_ = false;
}

void SensorInput::count(EgoMotionCounters* counters) const {
  const FrameAssemblerCounters& assembler = assembler_.counters();
  counters->rejected_imu += imu_buffer_.faults().total() + imu_gate_.dropped();
  counters->late_images += assembler.late_images;
  counters->rejected_images += assembler.invalid_images + assembler.implausible_stamps + assembler.duplicate_images +
                               image_monitor_.wrongSizes();
}

// IMU and images whose times do not meet.
std::optional<std::string> SensorInput::apart() const {
  const std::int64_t image_ns = *std::max_element(latest_image_ns_.begin(), latest_image_ns_.end());
  if (!use_imu_ || image_ns == 0 || imu_buffer_.latestStamp() == 0) return std::nullopt;
  const double behind_s = seconds(image_ns - imu_buffer_.latestStamp());
  char text[100];
  if (behind_s > max_imu_wait_s_) {
    std::snprintf(text, sizeof(text), "IMU: newest sample %.1f s behind the images: silent, late, or clocks apart?",
                  behind_s);
  } else if (behind_s < -kImagesFarBehind) {
    std::snprintf(text, sizeof(text), "images: newest %.1f s behind the IMU: silent, late, or clocks apart?",
                  -behind_s);
  } else {
    return std::nullopt;
  }
  return text;
}

std::vector<std::string> SensorInput::faults() const {
  std::vector<std::string> all = imu_monitor_.faults();
  if (const auto fault = apart()) all.push_back(*fault);
  for (int camera = 0; camera < rig_.size(); ++camera) {
    const FrameAssembler::Delivery delivery = assembler_.delivery(camera, now_ns_);
    if (delivery == FrameAssembler::Delivery::kInTime || !image_monitor_.rightSize(camera)) continue;
    all.push_back((delivery == FrameAssembler::Delivery::kNone ? "no images of " : "images too late of ") +
                  rig_.camera(camera).name);
  }
  for (const std::string& fault : image_monitor_.faults()) all.push_back(fault);
  return all;
}

}  // namespace multicam_egomotion
