// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <string>

#include "euroc_excerpt.h"

namespace multicam_egomotion {
namespace {

namespace fs = std::filesystem;

struct TrajectoryError {
  double ate = 0.0;    // root mean square after position and yaw [m]
  double scale = 1.0;  // of the similarity that fits best
};

TrajectoryError compare(const std::vector<Eigen::Isometry3d>& truth, const std::vector<Eigen::Isometry3d>& found) {
  const int n = static_cast<int>(truth.size());
  Eigen::Matrix3Xd to(3, n), from(3, n);
  for (int i = 0; i < n; ++i) {
    to.col(i) = truth[i].translation();
    from.col(i) = found[i].translation();
  }
  TrajectoryError error;
  const Eigen::Vector3d to_mean = to.rowwise().mean(), from_mean = from.rowwise().mean();
  to.colwise() -= to_mean;
  from.colwise() -= from_mean;
  const double sine = (from.row(0).array() * to.row(1).array() - from.row(1).array() * to.row(0).array()).sum();
  const double cosine = (from.row(0).array() * to.row(0).array() + from.row(1).array() * to.row(1).array()).sum();
  const Eigen::Matrix3d R = expSO3({0.0, 0.0, std::atan2(sine, cosine)});
  error.ate = std::sqrt((R * from - to).squaredNorm() / n);
  // Scale of the best similarity (Umeyama, PAMI 1991).
  Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
  for (int i = 0; i < n; ++i) moments += to.col(i) * from.col(i).transpose();
  const Eigen::Vector3d singular = Eigen::JacobiSVD<Eigen::Matrix3d>(moments).singularValues();
  error.scale = from.squaredNorm() / (singular[0] + singular[1] + std::copysign(singular[2], moments.determinant()));
  return error;
}

TEST(EgoMotionRecorded, EurocMh01) {
  const std::optional<EurocExcerpt> euroc = eurocExcerpt();
  if (!euroc) GTEST_SKIP() << "euroc_mh01_excerpt is not there";
  const Recording& recording = euroc->recording;
  EgoMotion odometry(euroc->rig, euroc->imu, {});
  RecordingPlayer player(recording);
  std::vector<EgoMotionResult> results = player.play(&odometry, 0, recording.frames);
  for (const EgoMotionResult& one : odometry.finish()) results.push_back(one);
  ASSERT_EQ(static_cast<int>(results.size()), recording.frames);
  std::vector<Eigen::Isometry3d> true_poses, found_poses;
  for (std::size_t i = 0; i < results.size(); ++i) {
    EXPECT_TRUE(results[i].has_pose) << i;
    EXPECT_EQ(results[i].has_relative_pose, i > 0) << i;
    true_poses.push_back(poseAt(euroc->truth, results[i].stamp_ns));
    found_poses.push_back(results[i].T_odom_body.pose);
  }
  const TrajectoryError error = compare(true_poses, found_poses);
  std::vector<double> positions, angles;
  for (std::size_t i = 0; i + 10 < results.size(); ++i) {
    const Eigen::Isometry3d difference =
        (true_poses[i].inverse() * true_poses[i + 10]).inverse() * (found_poses[i].inverse() * found_poses[i + 10]);
    positions.push_back(difference.translation().norm());
    angles.push_back(logSO3(difference.linear()).norm() * 180.0 / M_PI);
  }
  std::printf("ATE %.1f mm, scale %.4f, 0.5 s: %.2f mm, %.3f deg\n", 1e3 * error.ate, error.scale,
              1e3 * medianOf(positions), medianOf(angles));
  EXPECT_LE(error.ate, 0.015);
  EXPECT_NEAR(error.scale, 1.0, 0.03);
  EXPECT_LE(medianOf(positions), 0.006);
  EXPECT_LE(medianOf(angles), 0.15);
}

TEST(EgoMotionRecorded, Kitti03WithoutImu) {
  const fs::path folder = dataFolder() / "kitti_odometry_excerpt" / "sequences" / "03";
  const fs::path poses = dataFolder() / "kitti_odometry_excerpt" / "poses" / "03.txt";
  if (!fs::exists(folder / "calib.txt") || !fs::exists(poses)) GTEST_SKIP() << "KITTI 03 is not there";
  const std::vector<std::vector<double>> calibration = numbersIn(folder / "calib.txt");
  Eigen::Matrix3d R_body_cam;  // x forward, z up
  R_body_cam << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  const cv::Mat sample = cv::imread((folder / "image_0" / "000000.png").string(), cv::IMREAD_GRAYSCALE);
  ASSERT_FALSE(sample.empty());
  std::vector<RigCamera> cameras;
  for (int camera : {0, 1}) {
    const std::vector<double>& row = calibration[camera];  // P0: and twelve numbers
    Eigen::Isometry3d T_body_cam = Eigen::Isometry3d::Identity();
    T_body_cam.linear() = R_body_cam;
    T_body_cam.translation() = R_body_cam * Eigen::Vector3d(-row[4] / row[1], 0.0, 0.0);
    const std::string name = "cam" + std::to_string(camera);
    cameras.push_back({name, name,
                       CameraModel(sample.cols, sample.rows, row[1], row[6], row[3], row[7], Distortion::kNone, {}),
                       T_body_cam, 0.0});
  }
  Recording recording;
  const std::vector<std::vector<double>> times = numbersIn(folder / "times.txt");
  const std::vector<std::vector<double>> rows = numbersIn(poses);
  recording.frames = static_cast<int>(std::min(times.size(), rows.size()));
  recording.stamp = [&](int frame) { return 1000000000 + std::llround(1e9 * times[frame][0]); };
  recording.images = [&](int frame) {
    char file[16];
    std::snprintf(file, sizeof(file), "%06d.png", frame);
    std::vector<CameraImage> images;
    for (int camera : {0, 1}) {
      const fs::path path = folder / ("image_" + std::to_string(camera)) / file;
      images.push_back({camera, recording.stamp(frame), cv::imread(path.string(), cv::IMREAD_GRAYSCALE)});
    }
    return images;
  };

  EgoMotionOptions options;
  options.use_imu = false;
  EgoMotion odometry(CameraRig(cameras), ImuCalibration(), options);
  RecordingPlayer player(recording);
  std::vector<EgoMotionResult> results = player.play(&odometry, 0, recording.frames);
  for (const EgoMotionResult& one : odometry.finish()) results.push_back(one);
  ASSERT_EQ(static_cast<int>(results.size()), recording.frames);

  std::vector<Eigen::Isometry3d> truth;  // of the body
  std::vector<double> path = {0.0};
  for (int i = 0; i < recording.frames; ++i) {
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    for (int k = 0; k < 12; ++k) T.matrix()(k / 4, k % 4) = rows[i][k];
    T.linear() = Eigen::Quaterniond(T.linear()).normalized().toRotationMatrix();
    truth.push_back(cameras[0].T_body_cam * T * cameras[0].T_body_cam.inverse());
    if (i > 0) path.push_back(path.back() + (truth[i].translation() - truth[i - 1].translation()).norm());
  }
  std::vector<double> rotation_errors, direction_errors;
  double drift = 0.0;
  int stretches = 0;
  for (int i = 0; i < recording.frames; ++i) {
    if (i > 0) {
      const Eigen::Isometry3d T = truth[i - 1].inverse() * truth[i];
      const Eigen::Isometry3d found = results[i].T_previous_body.pose;
      rotation_errors.push_back(logSO3(T.linear().transpose() * found.linear()).norm() * 180.0 / M_PI);
      direction_errors.push_back(
          std::acos(std::min(1.0, T.translation().normalized().dot(found.translation().normalized()))) * 180.0 / M_PI);
      EXPECT_TRUE(results[i].has_relative_pose) << i;
    }
    const auto end = std::lower_bound(path.begin() + i, path.end(), path[i] + 50.0);
    if (end == path.end()) continue;
    const std::size_t j = end - path.begin();
    const Eigen::Isometry3d difference = (truth[i].inverse() * truth[j]).inverse() *
                                         (results[i].T_odom_body.pose.inverse() * results[j].T_odom_body.pose);
    drift += difference.translation().norm() / (path[j] - path[i]);
    ++stretches;
  }
  ASSERT_GT(stretches, 0);
  drift *= 100.0 / stretches;
  std::printf("50 m: %.2f %%, rotation %.4f deg, direction %.3f deg\n", drift, medianOf(rotation_errors),
              medianOf(direction_errors));
  EXPECT_LE(drift, 1.3);
  EXPECT_LE(medianOf(rotation_errors), 0.05);
  EXPECT_LE(medianOf(direction_errors), 0.75);
}

}  // namespace
}  // namespace multicam_egomotion
