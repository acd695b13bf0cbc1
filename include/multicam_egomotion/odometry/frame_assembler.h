// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <vector>

#include "multicam_egomotion/tracking/frame_set.h"

namespace multicam_egomotion {

struct FrameAssemblerOptions {
  double sync_slop_s = 0.01;      ///< largest distance of the stamps within a set [s]; KITTI raw pairs differ by 7 ms
  double sync_timeout_s = 0.05;   ///< how long a set waits for a live camera after its first image [s]
  int min_cameras = 1;            ///< a set with fewer images is dropped
  double max_stamp_jump_s = 1.0;  ///< a single stamp further off than this is a fault, several in a row a jump [s]
};

/// Totals since construction; reset() keeps them.
struct FrameAssemblerCounters {
  std::uint64_t sets = 0;                 ///< emitted
  std::uint64_t incomplete_sets = 0;      ///< emitted without an image of every camera
  std::uint64_t too_small_sets = 0;       ///< dropped, fewer images than min_cameras
  std::uint64_t late_images = 0;          ///< arrived after their set was decided; dropped
  std::uint64_t duplicate_images = 0;     ///< same camera and stamp as an earlier one; dropped
  std::uint64_t out_of_order_images = 0;  ///< older than one already received from the camera; used if still in time
  std::uint64_t overflow_images = 0;      ///< dropped because time stood still for too many images
  std::uint64_t invalid_images = 0;       ///< unknown camera, no pixels, or a stamp that is not positive; dropped
  std::uint64_t implausible_stamps = 0;   ///< stamps off by more than max_stamp_jump_s; dropped
  std::uint64_t time_jumps_back = 0;  ///< data time or a camera's stamps went back for good: the owner should reset()
};

/// Groups the images of N cameras into frame sets by their stamps (plus the cameras' time offsets).
///
/// A set is emitted as soon as every live camera that is due has an image within sync_slop, or can have none any more
/// because a later one came, or sync_timeout after the set's first image. A camera missing from 3 consecutive sets is
/// not live, and not waited for, until it returns. A camera of a lower rate is not missing between its images. Sets
/// come in the order of their stamps; the reference stamp is that of the lowest-numbered camera in the set. `now_ns` is
/// data time, in any epoch, passed by the caller: no clock is read. Faults of data are counted, never thrown.
class FrameAssembler {
 public:
  /// `time_offsets_ns` per camera, t_common = t_image + offset; empty: all 0. Throws std::invalid_argument on wrong
  /// options.
  FrameAssembler(int cameras, const FrameAssemblerOptions& options,
                 const std::vector<std::int64_t>& time_offsets_ns = {});

  void add(CameraImage image, std::int64_t now_ns);

  /// The sets that are ready at `now_ns`, in stamp order.
  std::vector<FrameSet> advance(std::int64_t now_ns);

  /// Forgets images, stamps and liveness, as at the start.
  void reset();

  const FrameAssemblerCounters& counters() const { return counters_; }
  bool live(int camera) const { return cameras_[camera].live; }
  enum class Delivery { kInTime, kLate, kNone };
  /// Whether a camera's images come, and in time to be used: not live, or overdue at `now_ns`, is not in time.
  Delivery delivery(int camera, std::int64_t now_ns) const;
  int liveCameras() const;

 private:
  struct Pending {
    CameraImage image;
    std::int64_t time_ns;     ///< stamp plus time offset
    std::int64_t arrival_ns;  ///< data time
  };
  struct Camera {
    std::int64_t offset_ns = 0;
    std::deque<Pending> pending;  ///< by time
    bool live = true;
    int consecutive_misses = 0;
    bool seen = false;
    std::int64_t newest_ns = 0;          ///< largest time received
    std::int64_t newest_arrival_ns = 0;  ///< and when
    std::int64_t last_used_ns = 0;       ///< time of the image in the last set that had one
    std::array<std::int64_t, 4> intervals_ns{};
    int intervals = 0;
    int implausible_in_a_row = 0;
  };
  struct Candidate {
    std::int64_t begin_ns, end_ns;  ///< times that belong to the set
    std::int64_t first_arrival_ns;
    int images;
    bool waiting;  ///< a live camera may still deliver
  };

  bool plausible(Camera* camera, std::int64_t time_ns, std::int64_t now_ns);
  bool isDuplicate(const Camera& camera, std::int64_t time_ns) const;
  bool isLate(const Camera& camera, std::int64_t time_ns) const;
  static std::int64_t shortestInterval(const Camera& camera);
  bool isDue(const Camera& camera, std::int64_t end_ns) const;
  bool nextCandidate(Candidate* candidate) const;
  void take(const Candidate& candidate, std::vector<FrameSet>* ready);

  std::vector<Camera> cameras_;
  std::int64_t slop_ns_, timeout_ns_, jump_ns_;
  int min_cameras_;
  FrameAssemblerCounters counters_;

  bool started_ = false;  ///< a time has been received
  std::int64_t now_ns_ = 0;
  bool decided_ = false;  ///< a set has been decided
  Candidate last_{};      ///< the last decided set
  std::int64_t last_stamp_ns_ = 0;
};

}  // namespace multicam_egomotion
