// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "multicam_egomotion/odometry/frame_assembler.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>
#include <utility>

namespace multicam_egomotion {
namespace {

constexpr int kMissesUntilNotLive = 3;
constexpr int kImplausibleUntilJump = 3;
constexpr std::size_t kMaxPending = 16;  // images a camera

std::int64_t nanoseconds(const char* name, double seconds) {
  if (!(seconds >= 0 && seconds <= 3600)) {
    std::ostringstream text;
    text << "frame assembler: " << name << " is " << seconds << ", expected 0 to 3600 s";
    throw std::invalid_argument(text.str());
  }
  return std::llround(seconds * 1e9);
}

void expectWithin(const char* name, int value, int least, int most) {
  if (value >= least && value <= most) return;
  throw std::invalid_argument(std::string("frame assembler: ") + name + " is " + std::to_string(value) + ", expected " +
                              std::to_string(least) + " to " + std::to_string(most));
}

}  // namespace

FrameAssembler::FrameAssembler(int cameras, const FrameAssemblerOptions& options,
                               const std::vector<std::int64_t>& time_offsets_ns)
    : slop_ns_(nanoseconds("sync_slop_s", options.sync_slop_s)),
      timeout_ns_(nanoseconds("sync_timeout_s", options.sync_timeout_s)),
      jump_ns_(nanoseconds("max_stamp_jump_s", options.max_stamp_jump_s)),
      min_cameras_(options.min_cameras) {
  expectWithin("number of cameras", cameras, 1, 1000);
  expectWithin("min_cameras", options.min_cameras, 1, cameras);
  if (!time_offsets_ns.empty()) {
    expectWithin("number of time offsets", static_cast<int>(time_offsets_ns.size()), cameras, cameras);
  }
  cameras_.resize(cameras);
  for (std::size_t i = 0; i < time_offsets_ns.size(); ++i) cameras_[i].offset_ns = time_offsets_ns[i];
}

void FrameAssembler::reset() {
  for (Camera& camera : cameras_) {
    const std::int64_t offset_ns = camera.offset_ns;
    camera = Camera();
    camera.offset_ns = offset_ns;
  }
  started_ = false;
  decided_ = false;
}

int FrameAssembler::liveCameras() const {
  return static_cast<int>(std::count_if(cameras_.begin(), cameras_.end(), [](const Camera& c) { return c.live; }));
}

void FrameAssembler::add(CameraImage image, std::int64_t now_ns) {
  if (image.camera < 0 || image.camera >= static_cast<int>(cameras_.size()) || image.grey.empty() ||
      image.stamp_ns <= 0) {
    ++counters_.invalid_images;
    return;
  }
  if (started_ && now_ns < now_ns_ - jump_ns_) ++counters_.time_jumps_back;
  started_ = true;
  now_ns_ = now_ns;

  Camera& camera = cameras_[image.camera];
  const std::int64_t time_ns = image.stamp_ns + camera.offset_ns;
  if (!plausible(&camera, time_ns, now_ns)) {
    ++counters_.implausible_stamps;
    return;
  }
  if (isDuplicate(camera, time_ns)) {
    ++counters_.duplicate_images;
    return;
  }
  if (camera.seen && time_ns < camera.newest_ns) {
    ++counters_.out_of_order_images;
  } else {
    if (camera.seen) camera.intervals_ns[camera.intervals++ % camera.intervals_ns.size()] = time_ns - camera.newest_ns;
    camera.seen = true;
    camera.newest_ns = time_ns;
    camera.newest_arrival_ns = now_ns;
  }

  if (isLate(camera, time_ns)) {
    ++counters_.late_images;
    // A camera that comes back is late only because no one waited for it: wait again from the next set on.
    if (!camera.live && time_ns >= last_.begin_ns - slop_ns_ && now_ns - last_.first_arrival_ns < timeout_ns_) {
      camera.live = true;
      camera.consecutive_misses = 0;
    }
    return;
  }
  camera.live = true;
  const auto after = std::upper_bound(camera.pending.begin(), camera.pending.end(), time_ns,
                                      [](std::int64_t t, const Pending& p) { return t < p.time_ns; });
  camera.pending.insert(after, Pending{std::move(image), time_ns, now_ns});
  if (camera.pending.size() > kMaxPending) {
    camera.pending.pop_front();
    ++counters_.overflow_images;
  }
}

// A stamp may be as much later than the camera's newest as time has passed, and a little out of order. One that is far
// off is a fault; several in a row are a new time of the camera: forwards it is followed, backwards reported.
bool FrameAssembler::plausible(Camera* camera, std::int64_t time_ns, std::int64_t now_ns) {
  const Camera* reference = camera;
  for (const Camera& other : cameras_) {
    if (!camera->seen && other.seen) reference = &other;
  }
  if (!reference->seen) return true;
  const std::int64_t passed_ns = std::max<std::int64_t>(0, now_ns - reference->newest_arrival_ns);
  const bool too_early = time_ns < reference->newest_ns - jump_ns_;
  const bool too_late = time_ns > reference->newest_ns + passed_ns + jump_ns_;
  if (!too_early && !too_late) {
    camera->implausible_in_a_row = 0;
    return true;
  }
  if (++camera->implausible_in_a_row < kImplausibleUntilJump || !camera->seen) return false;
  camera->implausible_in_a_row = 0;
  if (too_early) ++counters_.time_jumps_back;
  return too_late;
}

bool FrameAssembler::isDuplicate(const Camera& camera, std::int64_t time_ns) const {
  if (!camera.seen) return false;
  return time_ns == camera.newest_ns || time_ns == camera.last_used_ns ||
         std::any_of(camera.pending.begin(), camera.pending.end(),
                     [time_ns](const Pending& p) { return p.time_ns == time_ns; });
}

bool FrameAssembler::isLate(const Camera& camera, std::int64_t time_ns) const {
  if (!decided_) return false;
  const bool in_last = camera.last_used_ns >= last_.begin_ns;
  return time_ns <= (in_last ? camera.last_used_ns : last_.end_ns);
}

// A frame lost only widens one of the last intervals. 0 before there is one.
std::int64_t FrameAssembler::shortestInterval(const Camera& camera) {
  const int n = std::min<int>(camera.intervals, camera.intervals_ns.size());
  return n == 0 ? 0 : *std::min_element(camera.intervals_ns.begin(), camera.intervals_ns.begin() + n);
}

FrameAssembler::Delivery FrameAssembler::delivery(int camera, std::int64_t now_ns) const {
  const Camera& one = cameras_[camera];
  const std::int64_t period_ns = shortestInterval(one);
  const bool comes = period_ns > 0 && now_ns - one.newest_arrival_ns <= kMissesUntilNotLive * period_ns + timeout_ns_;
  if (!one.live) return comes ? Delivery::kLate : Delivery::kNone;
  return comes || period_ns == 0 ? Delivery::kInTime : Delivery::kNone;
}

// Whether the camera should have an image until `end_ns`.
bool FrameAssembler::isDue(const Camera& camera, std::int64_t end_ns) const {
  const std::int64_t period_ns = shortestInterval(camera);
  if (period_ns == 0) return true;
  return camera.newest_ns + period_ns - period_ns / 16 <= end_ns + slop_ns_;
}

bool FrameAssembler::nextCandidate(Candidate* candidate) const {
  bool found = false;
  for (const Camera& camera : cameras_) {
    if (camera.pending.empty()) continue;
    const std::int64_t time_ns = camera.pending.front().time_ns;
    if (!found || time_ns < candidate->begin_ns) candidate->begin_ns = time_ns;
    found = true;
  }
  if (!found) return false;
  candidate->end_ns = candidate->begin_ns + slop_ns_;
  candidate->images = 0;
  candidate->waiting = false;
  for (const Camera& camera : cameras_) {
    if (camera.pending.empty()) {
      candidate->waiting |= camera.live && isDue(camera, candidate->end_ns);
      continue;
    }
    const Pending& first = camera.pending.front();
    if (first.time_ns > candidate->end_ns) continue;
    candidate->first_arrival_ns =
        candidate->images == 0 ? first.arrival_ns : std::min(candidate->first_arrival_ns, first.arrival_ns);
    ++candidate->images;
  }
  return true;
}

void FrameAssembler::take(const Candidate& candidate, std::vector<FrameSet>* ready) {
  FrameSet set;
  set.images.reserve(candidate.images);
  for (Camera& camera : cameras_) {
    if (!camera.pending.empty() && camera.pending.front().time_ns <= candidate.end_ns) {
      camera.last_used_ns = camera.pending.front().time_ns;
      camera.consecutive_misses = 0;
      set.images.push_back(std::move(camera.pending.front().image));
      camera.pending.pop_front();
    } else if (camera.live && isDue(camera, candidate.end_ns) && ++camera.consecutive_misses >= kMissesUntilNotLive) {
      camera.live = false;
    }
  }
  // Images that would have belonged to this set are late from now on, also those of a set that is too small.
  const bool in_order = !decided_ || set.images.front().stamp_ns > last_stamp_ns_;
  decided_ = true;
  last_ = candidate;
  if (candidate.images < min_cameras_) {
    ++counters_.too_small_sets;
    return;
  }
  if (!in_order) {
    counters_.late_images += set.images.size();
    return;
  }
  set.stamp_ns = set.images.front().stamp_ns;
  last_stamp_ns_ = set.stamp_ns;
  ++counters_.sets;
  counters_.incomplete_sets += set.images.size() < cameras_.size();
  ready->push_back(std::move(set));
}

std::vector<FrameSet> FrameAssembler::advance(std::int64_t now_ns) {
  std::vector<FrameSet> ready;
  Candidate candidate{};
  while (nextCandidate(&candidate)) {
    if (candidate.waiting && now_ns - candidate.first_arrival_ns < timeout_ns_) break;
    take(candidate, &ready);
  }
  return ready;
}

}  // namespace multicam_egomotion
