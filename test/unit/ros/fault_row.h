// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

namespace multicam_egomotion {

/// What is expected of the odometry while faults work on a recording. Built by chained calls; times in seconds since
/// the bag's begin.
struct FaultRow {
  FaultRow(std::string row_name, std::vector<std::string> row_faults)
      : name(std::move(row_name)), faults(std::move(row_faults)) {}

  /// The faults work from `begin` to `end`: before, the output is that without them; after, it is as accurate. With the
  /// start in motion the vertical takes some 1.5 s: what is judged begins later.
  FaultRow& during(double begin, double end) {
    begin_s = begin;
    end_s = end;
    return *this;
  }
  /// A value of /diagnostics is at least this at the end. Counts of faults that are not named here must be 0.
  FaultRow& counts(const std::string& key, double at_least) {
    least.emplace_back(key, at_least);
    return *this;
  }
  /// The summary of /diagnostics contains this while the faults work, first within so many seconds.
  FaultRow& says(const std::string& text, double within_s = std::numeric_limits<double>::infinity()) {
    summaries.emplace_back(text, within_s);
    return *this;
  }
  /// What is said needs a rotation of 30 deg first, and is not checkable until then.
  FaultRow& onceTurned() {
    once_turned = true;
    return *this;
  }
  /// At least this share of the recording's frames has a pose.
  FaultRow& poses(double share) {
    pose_share = share;
    return *this;
  }
  /// The stamps of the images are off by so much after the fault.
  FaultRow& stampsOffBy(double seconds) {
    stamp_shift_s = seconds;
    return *this;
  }
  /// The faults make the stamps go back without a new odom epoch.
  FaultRow& stampsJump() {
    stamps_jump = true;
    return *this;
  }
  FaultRow& epochs(int n) {
    odom_epochs = n;
    return *this;
  }
  /// Drift after the faults: so many times that without them, plus the allowance.
  FaultRow& drifts(double factor, double allowance_m, double allowance_deg) {
    drift_factor = factor;
    drift_allowance_m = allowance_m;
    drift_allowance_deg = allowance_deg;
    return *this;
  }
  /// At most this share of the positions is further from the truth than 3 sigma.
  FaultRow& beyondThreeSigma(double share) {
    beyond_three_sigma_share = share;
    return *this;
  }
  /// The error of the position grows by no more than this from just before the faults on, and the truth is always
  /// within 3 sigma.
  FaultRow& gainsAtMost(double position_m) {
    most_gained_m = position_m;
    return *this;
  }
  /// The data are wrong throughout: the fault is to be named, the accuracy is not judged.
  FaultRow& onlyNamed() {
    accurate = false;
    return *this;
  }
  FaultRow& with(const std::string& parameter, const std::string& value) {
    parameters.emplace_back(parameter, value);
    return *this;
  }
  /// Nothing runs; the error contains this.
  FaultRow& refused(const std::string& text) {
    refusal = text;
    return *this;
  }

  std::string name;
  std::vector<std::string> faults;
  double begin_s = 0.0, end_s = 1.5;
  double beyond_three_sigma_share = 0.05;
  std::vector<std::pair<std::string, double>> least;
  std::vector<std::pair<std::string, double>> summaries;
  bool once_turned = false;
  double pose_share = 1.0;
  double stamp_shift_s = 0.0;
  bool stamps_jump = false;
  int odom_epochs = 1;
  bool accurate = true;
  double most_gained_m = std::numeric_limits<double>::infinity();
  double drift_factor = 1.5, drift_allowance_m = 0.005, drift_allowance_deg = 0.1;
  std::vector<std::pair<std::string, std::string>> parameters;
  std::string refusal;
};

inline void PrintTo(const FaultRow& row, std::ostream* stream) { *stream << row.name; }

}  // namespace multicam_egomotion
