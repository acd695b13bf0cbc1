// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "paper_experiments/csv_file.h"
#include "paper_experiments/experiments.h"
#include "paper_experiments/kitti_runs.h"
#include "paper_experiments/pose_errors.h"

namespace multicam_egomotion {
namespace {

constexpr double kMoving = 0.1;  // displacement of which the ground truth knows the direction [m]

using State = PairEstimate::State;

PoseErrors errorsOf(const PairEstimate& estimate, const Eigen::Isometry3d& truth) {
  if (estimate.state == State::kFailed) return {};
  return poseErrors(estimate.T_f2_f1.linear(), estimate.T_f2_f1.translation(), truth.linear(), truth.translation());
}

// Median errors of a seed [deg]; pairs whose prior is undefined do not count.
struct Medians {
  double rotation, translation, moving_translation;
};

Medians mediansOf(const KittiSequence& sequence, const std::vector<PairEstimate>& estimates) {
  std::vector<double> rotation, translation, moving;
  for (std::size_t i = 0; i < estimates.size(); ++i) {
    if (estimates[i].state == State::kUndefined) continue;
    const Eigen::Isometry3d truth = sequence.motion(i);
    const PoseErrors errors = errorsOf(estimates[i], truth);
    rotation.push_back(errors.rotation / kDegree);
    translation.push_back(errors.translation / kDegree);
    if (truth.translation().norm() > kMoving) moving.push_back(errors.translation / kDegree);
  }
  return {median(rotation), median(translation), median(moving)};
}

int countOf(const KittiRun& run, State state) {
  const auto& first = run.estimates.front();
  return static_cast<int>(
      std::count_if(first.begin(), first.end(), [&](const PairEstimate& one) { return one.state == state; }));
}

double spread(const std::vector<double>& values) {
  const auto [least, most] = std::minmax_element(values.begin(), values.end());
  return *most - *least;
}

class KittiTables {
 public:
  explicit KittiTables(const std::string& out)
      : rotation_(out + "/table2_rotation.csv", header()),
        translation_(out + "/table3_translation.csv", header() + ",median_moving_deg") {}

  void addMissing(const std::string& sequence) {
    const double none = std::nan("");
    std::vector<std::string> methods;
    for (const PaperSolver& solver : paperSolvers()) methods.push_back(solver.name);
    methods.insert(methods.end(), {"ours", "ours-no-prior"});
    for (const std::string& method : methods) {
      rotation_.row(sequence, std::string("no data"), method, none, none, none, none, none);
      translation_.row(sequence, std::string("no data"), method, none, none, none, none, none, none);
    }
  }

  void add(const KittiSequence& sequence, const KittiRun& run) {
    std::vector<double> rotation, translation, moving;
    for (const auto& estimates : run.estimates) {
      const Medians medians = mediansOf(sequence, estimates);
      rotation.push_back(medians.rotation);
      translation.push_back(medians.translation);
      moving.push_back(medians.moving_translation);
    }
    const KittiFolder& folder = sequence.folder;
    const std::size_t pairs = run.estimates.front().size();
    const int failed = countOf(run, State::kFailed) + countOf(run, State::kPredicted);
    const int undefined = countOf(run, State::kUndefined);
    rotation_.row(folder.sequence, folder.source, run.method, pairs, failed, undefined, median(rotation),
                  spread(rotation));
    translation_.row(folder.sequence, folder.source, run.method, pairs, failed, undefined, median(translation),
                     spread(translation), median(moving));
  }

 private:
  static std::string header() { return "sequence,source,method,pairs,failed,undefined_prior,median_deg,spread_deg"; }

  CsvFile rotation_, translation_;
};

// Positions of the body in the world, from the first pose on.
Eigen::Matrix3Xd accumulate(const Eigen::Isometry3d& start, const std::vector<PairEstimate>& estimates) {
  Eigen::Matrix3Xd positions(3, estimates.size() + 1);
  Eigen::Isometry3d T = start;
  positions.col(0) = T.translation();
  for (std::size_t i = 0; i < estimates.size(); ++i) {
    T = T * estimates[i].T_f2_f1.inverse();
    positions.col(i + 1) = T.translation();
  }
  return positions;
}

// Absolute trajectory errors after the alignment by a rigid motion (Sturm et al. 2012).
void writeTrajectory(const KittiSequence& sequence, const KittiRun& run, CsvFile* csv) {
  Eigen::Matrix3Xd truth(3, sequence.T_world_body.size());
  for (Eigen::Index i = 0; i < truth.cols(); ++i) truth.col(i) = sequence.T_world_body[i].translation();
  const Eigen::Matrix3Xd positions = accumulate(sequence.T_world_body.front(), run.estimates.front());
  const Eigen::Isometry3d T(Eigen::umeyama(positions, truth, false));
  for (Eigen::Index i = 0; i < truth.cols(); ++i) {
    const Eigen::Vector3d aligned = T * Eigen::Vector3d(positions.col(i));
    csv->row(sequence.folder.sequence, sequence.folder.source, run.method, static_cast<int>(i), truth(0, i),
             truth(1, i), truth(2, i), aligned.x(), aligned.y(), aligned.z(), (aligned - truth.col(i)).norm());
  }
}

}  // namespace

void runKittiExperiments(const ExperimentOptions& options) {
  std::vector<KittiFolder> folders;
  if (!options.data.empty()) folders = findKittiFolders(options.data);
  KittiTables tables(options.out);
  CsvFile trajectories(options.out + "/fig7_trajectory.csv",
                       "sequence,source,method,frame,x_true_m,y_true_m,z_true_m,x_m,y_m,z_m,error_m");
  const auto isOn = [&](const std::string& name) {
    return std::any_of(folders.begin(), folders.end(), [&](const KittiFolder& one) { return one.sequence == name; });
  };
  for (const std::string& name : kittiSequenceNames()) {
    if (!isOn(name)) tables.addMissing(name);
  }
  for (const KittiFolder& folder : folders) {
    KittiSequence sequence = loadKittiSequence(folder, options.frames);
    if (sequence.stamps_ns.size() < 2) throw std::runtime_error(folder.path + ": found fewer than two poses");
    for (const KittiRun& run : runKittiSequence(&sequence, options)) {
      tables.add(sequence, run);
      writeTrajectory(sequence, run, &trajectories);
    }
  }
}

}  // namespace multicam_egomotion
