// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

namespace multicam_egomotion {

struct ExperimentOptions {
  int trials = 1000;  ///< of each point of Figs. 4 to 6
  std::uint64_t seed = 1;
  int threads = 1;   ///< changes nothing but the time it takes
  std::string out;   ///< existing directory
  std::string data;  ///< searched for KITTI sequences; empty: none
  int frames = 0;    ///< at most of a sequence; 0: all
  int ransac_seeds = 5;

  /// Of Table I and Fig. 3: ten times as many as trials, as in the paper.
  int solverRuns() const { return 10 * trials; }
};

/// Table I: table1_runtime.csv. On one thread.
void runRuntimeExperiment(const ExperimentOptions& options);

/// Fig. 3: densities in fig3_stability.csv, quantiles and failures in fig3_quantiles.csv.
void runStabilityExperiment(const ExperimentOptions& options);

/// Figs. 4, 5 and 6: fig4_image_noise.csv, fig5_pitch_noise.csv, fig6_roll_noise.csv.
void runNoiseExperiments(const ExperimentOptions& options);

/// Tables II and III and Fig. 7: table2_rotation.csv, table3_translation.csv, fig7_trajectory.csv. Sequences that are
/// not there have rows that say "no data".
void runKittiExperiments(const ExperimentOptions& options);

}  // namespace multicam_egomotion
