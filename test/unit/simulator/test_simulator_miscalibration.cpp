// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <stdexcept>

#include "multicam_egomotion/geometry/so3.h"
#include "simulator/miscalibration.h"
#include "simulator/scenario_rig.h"

namespace multicam_egomotion {
namespace {

/// Mean and standard deviation of what is added.
struct Spread {
  double sum = 0.0, squares = 0.0;
  int count = 0;

  void add(double value) {
    sum += value;
    squares += value * value;
    ++count;
  }
  double mean() const { return sum / count; }
  double sigma() const { return std::sqrt(squares / count - mean() * mean()); }
};

/// Pixel of a ray of the true model at the corner of its image, in another model of the camera.
double cornerShift(const CameraModel& truth, const CameraModel& other) {
  const Eigen::Vector2d center(truth.cx(), truth.cy()),
      corner(truth.cx() < 319.5 ? 639 : 0, truth.cy() < 239.5 ? 479 : 0);
  Eigen::Vector3d bearing;
  Eigen::Vector2d pixel;
  EXPECT_TRUE(truth.unproject(corner, &bearing));
  EXPECT_TRUE(other.project(bearing, &pixel));
  return (pixel - corner).dot((corner - center).normalized());
}

class Miscalibration : public testing::TestWithParam<RigDescription (*)()> {};

TEST_P(Miscalibration, HasTheStandardDeviationsOfTheRig) {
  const RigDescription description = GetParam()();
  std::vector<RigCamera> cameras = description.cameras;
  cameras.back().sigmas.rotation *= 3.0;  // each camera's own
  cameras.back().sigmas.distortion_px = 1.0;
  const CameraRig truth(cameras);
  constexpr int kSeeds = 600;
  constexpr double kScale = 2.0;
  std::map<std::string, Spread> spreads;
  for (int seed = 1; seed <= kSeeds; ++seed) {
    const CalibratedRig wrong = miscalibrated(truth, description.imu, kScale, seed);
    ASSERT_EQ(wrong.rig.size(), truth.size());
    const double time_offset = wrong.rig.camera(0).time_offset_s - truth.camera(0).time_offset_s;
    spreads["time offset"].add(time_offset / 0.002);
    const Eigen::Vector3d mounting =
        logSO3(description.imu.T_body_imu.linear().transpose() * wrong.imu.T_body_imu.linear());
    for (int k = 0; k < 3; ++k) spreads["mounting"].add(mounting[k] / description.imu.mounting_sigma);
    EXPECT_EQ(wrong.imu.T_body_imu.translation(), description.imu.T_body_imu.translation());
    for (int i = 0; i < truth.size(); ++i) {
      const RigCamera &a = truth.camera(i), &b = wrong.rig.camera(i);
      const std::string name = a.name;
      EXPECT_NEAR(b.time_offset_s - a.time_offset_s, time_offset, 1e-15);
      const double factor = b.model.fx() / a.model.fx();
      EXPECT_NEAR(b.model.fy() / a.model.fy(), factor, 1e-12);
      spreads[name + " focal length"].add((factor - 1.0) / a.sigmas.focal_length);
      const CameraModel lens(a.model.width(), a.model.height(), a.model.fx(), a.model.fy(), a.model.cx(), a.model.cy(),
                             b.model.distortion(), b.model.coefficients());
      spreads[name + " distortion"].add(cornerShift(a.model, lens) / a.sigmas.distortion_px);
      if (i == 0) {
        EXPECT_LT((b.T_body_cam.matrix() - a.T_body_cam.matrix()).norm(), 1e-14);
        EXPECT_EQ(b.model.cx(), a.model.cx());
        EXPECT_EQ(b.model.cy(), a.model.cy());
        continue;
      }
      const Eigen::Vector3d turned = logSO3(a.T_body_cam.linear().transpose() * b.T_body_cam.linear());
      const Eigen::Vector3d moved = b.T_body_cam.translation() - a.T_body_cam.translation();
      for (int k = 0; k < 3; ++k) spreads[name + " rotation"].add(turned[k] / a.sigmas.rotation);
      for (int k = 0; k < 3; ++k) spreads[name + " position"].add(moved[k] / a.sigmas.position);
      spreads[name + " cx"].add((b.model.cx() - a.model.cx()) / a.sigmas.principal_point_px);
      spreads[name + " cy"].add((b.model.cy() - a.model.cy()) / a.sigmas.principal_point_px);
    }
  }
  for (const auto& [name, spread] : spreads) {
    const double error = kScale / std::sqrt(spread.count);  // of the mean
    EXPECT_NEAR(spread.mean(), 0.0, 4.0 * error) << name;
    EXPECT_NEAR(spread.sigma(), kScale, 4.0 * error / std::sqrt(2.0)) << name;
  }
}

TEST_P(Miscalibration, IsExactAtZeroAndTheSameForOneSeed) {
  const RigDescription description = GetParam()();
  const CameraRig truth(description.cameras);
  const CalibratedRig exact = miscalibrated(truth, description.imu, 0.0, 1);
  const CalibratedRig one = miscalibrated(truth, description.imu, 1.0, 7);
  const CalibratedRig same = miscalibrated(truth, description.imu, 1.0, 7);
  const CalibratedRig other = miscalibrated(truth, description.imu, 1.0, 8);
  EXPECT_EQ(exact.imu.T_body_imu.matrix(), description.imu.T_body_imu.matrix());
  EXPECT_EQ(one.imu.T_body_imu.matrix(), same.imu.T_body_imu.matrix());
  EXPECT_NE(one.imu.T_body_imu.matrix(), other.imu.T_body_imu.matrix());
  for (int i = 0; i < truth.size(); ++i) {
    EXPECT_EQ(exact.rig.camera(i).T_body_cam.matrix(), truth.camera(i).T_body_cam.matrix());
    EXPECT_EQ(exact.rig.camera(i).model.fx(), truth.camera(i).model.fx());
    EXPECT_EQ(exact.rig.camera(i).model.coefficients(), truth.camera(i).model.coefficients());
    EXPECT_EQ(exact.rig.camera(i).time_offset_s, truth.camera(i).time_offset_s);
    EXPECT_EQ(one.rig.camera(i).T_body_cam.matrix(), same.rig.camera(i).T_body_cam.matrix());
    EXPECT_EQ(one.rig.camera(i).model.coefficients(), same.rig.camera(i).model.coefficients());
    EXPECT_NE(one.rig.camera(i).model.coefficients(), other.rig.camera(i).model.coefficients());
  }
}

INSTANTIATE_TEST_SUITE_P(Rigs, Miscalibration, testing::Values(handheldRig, carRig, droneRig));

TEST(MiscalibrationOfOneCamera, AnIdealPinholeGetsADistortion) {
  const CameraModel pinhole(640, 480, 400.0, 400.0, 300.0, 250.0, Distortion::kNone, {});
  const CameraRig rig({{"a", "a", pinhole, Eigen::Isometry3d::Identity(), 0.0}});
  const CameraModel wrong = miscalibrated(rig, {}, 1.0, 3).rig.camera(0).model;
  EXPECT_EQ(wrong.distortion(), Distortion::kRadtan);
  EXPECT_NE(wrong.coefficients().at(0), 0.0);
  EXPECT_EQ(miscalibrated(rig, {}, 0.0, 3).rig.camera(0).model.distortion(), Distortion::kNone);
}

TEST(MiscalibrationOfOneCamera, RefusesScalesThatCannotBe) {
  const RigDescription description = stereoRig();
  const CameraRig rig(description.cameras);
  EXPECT_THROW(miscalibrated(rig, description.imu, -1.0, 1), std::invalid_argument);
  EXPECT_THROW(miscalibrated(rig, description.imu, std::numeric_limits<double>::quiet_NaN(), 1), std::invalid_argument);
}

}  // namespace
}  // namespace multicam_egomotion
