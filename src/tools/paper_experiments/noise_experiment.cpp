// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include <functional>

#include "paper_experiments/csv_file.h"
#include "paper_experiments/experiments.h"
#include "paper_experiments/parallel.h"
#include "paper_experiments/trial_errors.h"

namespace multicam_egomotion {
namespace {

constexpr int kLevels = 11;                // from 0 to 1 [px or deg]
constexpr double kLevelStep = 0.1;         // [px or deg]
constexpr double kImageNoiseOfTilt = 0.5;  // in Figs. 5 and 6 [px]

struct Figure {
  std::string title, file;
  std::string level_column;
  std::function<NoiseLevel(double)> noise;
  bool tilt;  // the priors are noisy: two ways for the axis, and nothing about the angle
};

// A curve: a solver, and how its prior is made noisy.
struct Curve {
  const PaperSolver* solver;
  AxisNoise axis_noise;
  std::string prior_noise;
};

std::vector<Curve> curves(bool tilt) {
  std::vector<Curve> all;
  for (const PaperSolver& solver : paperSolvers()) {
    if (!tilt) {
      all.push_back({&solver, AxisNoise::kTurned, "none"});
    } else if (solver.prior == PriorKind::kVertical) {
      all.push_back({&solver, AxisNoise::kTurned, "tilt"});
    } else if (solver.prior == PriorKind::kAxis) {
      all.push_back({&solver, AxisNoise::kEquivalent, "equivalent axis"});
      all.push_back({&solver, AxisNoise::kTurned, "turned axis"});
    }
  }
  return all;
}

double medianDegrees(const std::vector<TrialErrors>& errors, PoseErrors TrialErrors::*selection,
                     double PoseErrors::*error) {
  std::vector<double> values;
  for (const TrialErrors& one : errors) values.push_back((one.*selection).*error / kDegree);
  return median(values);
}

void runMotion(const ExperimentOptions& options, const Figure& figure, TwoCameraMotion motion, CsvFile* csv) {
  const std::vector<Curve> all = curves(figure.tilt);
  // By curve, level and trial.
  std::vector<std::vector<std::vector<TrialErrors>>> errors(
      all.size(), std::vector<std::vector<TrialErrors>>(kLevels, std::vector<TrialErrors>(options.trials)));
  forEachInParallel(figure.title + ", " + name(motion), options.trials, options.threads, [&](std::size_t i) {
    const TwoCameraTrial trial(motion, options.seed, i);
    for (int level = 0; level < kLevels; ++level) {
      const NoiseLevel noise = figure.noise(kLevelStep * level);
      const CorrespondenceSet further = trial.further(noise);
      for (std::size_t c = 0; c < all.size(); ++c) {
        const SolverProblem problem = trial.problem(noise, all[c].axis_noise);
        errors[c][level][i] = trialErrors(*all[c].solver, problem, trial, &further);
      }
    }
  });
  for (std::size_t c = 0; c < all.size(); ++c) {
    for (int level = 0; level < kLevels; ++level) {
      const std::vector<TrialErrors>& trials = errors[c][level];
      int unsolved = 0;
      for (const TrialErrors& one : trials) unsolved += !one.solved;
      for (const bool nearest : {true, false}) {
        const auto selection = nearest ? &TrialErrors::nearest : &TrialErrors::chosen;
        csv->row(name(motion), kLevelStep * level, std::string(nearest ? "nearest" : "vote"), all[c].prior_noise,
                 all[c].solver->name, options.trials, unsolved, medianDegrees(trials, selection, &PoseErrors::rotation),
                 medianDegrees(trials, selection, &PoseErrors::translation));
      }
    }
  }
}

}  // namespace

void runNoiseExperiments(const ExperimentOptions& options) {
  const auto image = [](double level) { return NoiseLevel{level, 0.0, 0.0}; };
  const auto pitch = [](double level) { return NoiseLevel{kImageNoiseOfTilt, level * kDegree, 0.0}; };
  const auto roll = [](double level) { return NoiseLevel{kImageNoiseOfTilt, 0.0, level * kDegree}; };
  const std::vector<Figure> figures = {{"Fig. 4: image noise", "fig4_image_noise.csv", "noise_px", image, false},
                                       {"Fig. 5: pitch noise", "fig5_pitch_noise.csv", "noise_deg", pitch, true},
                                       {"Fig. 6: roll noise", "fig6_roll_noise.csv", "noise_deg", roll, true}};
  for (const Figure& figure : figures) {
    CsvFile csv(options.out + "/" + figure.file,
                "motion," + figure.level_column +
                    ",selection,prior_noise,solver,trials,without_solution,median_rotation_deg,median_translation_deg");
    for (const TwoCameraMotion motion : kTwoCameraMotions) runMotion(options, figure, motion, &csv);
  }
}

}  // namespace multicam_egomotion
