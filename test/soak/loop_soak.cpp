// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
// The scenario `loop` again and again with stamps that go on, as fast as the machine can: memory and time a frame must
// stay as they are, and no warning may come back all the time. loop_soak [LAPS], 60 unless given; exit code 1 when
// something grows.
#include <array>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <exception>
#include <limits>
#include <set>

#include "../unit/ego_motion_run.h"
#include "../unit/scaled_rig.h"
#include "soak_quarter.h"
#include "stored_lap.h"

namespace multicam_egomotion {
namespace {

constexpr double kLapS = 60.0;
constexpr double kImageScale = 0.5;  // 320x240: an hour of data in some minutes
constexpr double kMemoryGrowth = 1.02, kTimeGrowth = 1.10, kErrorGrowth = 2.0;  // last against second quarter
constexpr double kLeastTracking = 0.999;                                        // of the frames
constexpr double kWarningsPerLap = 1.0;
const Eigen::Vector3d kNowhere = Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());

double cpuMs() {
  timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return 1e3 * static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_nsec);
}

double wallMs() {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

std::uint64_t faultCount(const EgoMotionCounters& counters) {
  return counters.frame_sets_without_imu + counters.estimation_failures + counters.time_jumps + counters.rejected_imu +
         counters.late_images + counters.rejected_images;
}

/// Plays the laps, sorted into four quarters, and prints these.
class LoopSoak {
 public:
  explicit LoopSoak(int laps) : laps_(laps), simulator_(scenario(laps)), lap_(simulator_, framesPerLap()) {
    recording_.frames = laps * framesPerLap();
    recording_.stamp = [this](int frame) { return simulator_.frameStamp(frame); };
    recording_.images = [this](int frame) { return lap_.images(frame % framesPerLap(), simulator_.frameStamp(frame)); };
    for (SoakQuarter& quarter : quarters_)
      quarter.reserve(static_cast<std::size_t>(recording_.frames / 4 + framesPerLap()));
  }

  void run() {
    SoakQuarter::printHeader();
    EgoMotion odometry(simulator_.scenario().rig, simulator_.scenario().imu, EgoMotionOptions());
    Eigen::Vector3d lap_start = kNowhere;
    for (int lap = 0; lap < laps_; ++lap) {
      SoakQuarter* quarter = &quarters_[4 * lap / laps_];
      recording_.imu.clear();
      const int end = (lap + 1) * framesPerLap();
      lap_.appendImuUntil(simulator_.frameStamp(end - 1) + RecordingPlayer::kLag, &recording_.imu);
      RecordingPlayer player(recording_);
      Eigen::Vector3d start = kNowhere;
      for (int frame = lap * framesPerLap(); frame < end; ++frame) {
        const Eigen::Vector3d position = playFrame(&odometry, &player, frame, quarter);
        if (frame == lap * framesPerLap()) start = position;
      }
      const double error = (start - lap_start).norm();
      if (std::isfinite(error)) quarter->lap_error_m.push_back(error);
      lap_start = start;
      const bool ends = lap + 1 == laps_ || quarter != &quarters_[4 * (lap + 1) / laps_];
      if (ends) quarter->print(4 * lap / laps_ + 1);
    }
  }

  /// Prints what was asked for and found; false when something has grown.
  bool report() const {
    SoakQuarter all;
    for (const SoakQuarter& quarter : quarters_) {
      all.frames += quarter.frames;
      all.tracking += quarter.tracking;
      all.warnings += quarter.warnings;
    }
    const SoakQuarter &second = quarters_[1], &last = quarters_[3];
    bool sound = true;
    const auto judge = [&sound](const char* what, double found, double limit, bool at_most) {
      const bool good = at_most ? found <= limit : found >= limit;
      std::printf("%-45s %8.4f, expected %s %.4f%s\n", what, found, at_most ? "at most" : "at least", limit,
                  good ? "" : "  FAILED");
      sound = sound && good;
    };
    judge("memory, last to second quarter", last.memory() / second.memory(), kMemoryGrowth, true);
    judge("p99 of the CPU time, last to second quarter", last.p99() / second.p99(), kTimeGrowth, true);
    judge("error of a lap, last to second quarter", quantile(last.lap_error_m, 0.5) / quantile(second.lap_error_m, 0.5),
          kErrorGrowth, true);
    judge("share of frames tracking", static_cast<double>(all.tracking) / static_cast<double>(all.frames),
          kLeastTracking, false);
    judge("warnings a lap", static_cast<double>(all.warnings) / laps_, kWarningsPerLap, true);
    return sound;
  }

 private:
  static Scenario scenario(int laps) {
    SimulationOptions options;
    options.duration_s = kLapS * laps;
    Scenario scenario = makeScenario("loop", options);
    scenario.rig = scaledRig(scenario.rig, kImageScale);
    return scenario;
  }

  int framesPerLap() const {
    return static_cast<int>(std::lround(kLapS * simulator_.scenario().options.image_rate_hz));
  }

  /// Position at a frame, not a number without one.
  Eigen::Vector3d playFrame(EgoMotion* odometry, RecordingPlayer* player, int frame, SoakQuarter* quarter) {
    double cpu_begin = 0.0, wall_begin = 0.0;
    const auto received = [&](int, std::vector<CameraImage>*) {
      cpu_begin = cpuMs();
      wall_begin = wallMs();
    };
    const std::vector<EgoMotionResult> results = player->play(odometry, frame, frame + 1, received);
    quarter->cpu_ms.push_back(cpuMs() - cpu_begin);
    quarter->wall_ms.push_back(wallMs() - wall_begin);

    ++quarter->frames;
    Eigen::Vector3d position = kNowhere;
    for (const EgoMotionResult& result : results) {
      if (result.stamp_ns != simulator_.frameStamp(frame) || !result.has_pose) continue;
      quarter->tracking += result.status == EgoMotionStatus::kTracking || frame < framesPerLap() / 20;
      position = result.T_odom_body.pose.translation();
    }
    const std::uint64_t faults = faultCount(odometry->counters());
    quarter->faults += faults - faults_;
    faults_ = faults;
    // A warning is a line that was not there before; numbers in it may change.
    std::set<std::string> named;
    for (const std::string& fault : odometry->faults())
      named.insert(fault.substr(0, fault.find_first_of("0123456789")));
    for (const std::string& fault : named) quarter->warnings += named_.count(fault) == 0;
    named_ = named;
    if (frame % 20 == 0) quarter->memory_mb.push_back(anonymousMemoryMb());
    return position;
  }

  int laps_;
  Simulator simulator_;
  StoredLap lap_;
  Recording recording_;
  std::array<SoakQuarter, 4> quarters_;
  std::uint64_t faults_ = 0;
  std::set<std::string> named_;
};

}  // namespace
}  // namespace multicam_egomotion

int main(int argc, char** argv) {
  const int laps = argc > 1 ? std::atoi(argv[1]) : 60;
  if (laps < 4) {
    std::fprintf(stderr, "%s: found '%s' laps, expected at least 4\n", argv[0], argc > 1 ? argv[1] : "");
    return 1;
  }
  try {
    multicam_egomotion::LoopSoak soak(laps);
    soak.run();
    return soak.report() ? 0 : 1;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s: %s\n", argv[0], error.what());
    return 1;
  }
}
