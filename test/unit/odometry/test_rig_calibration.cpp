// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "multicam_egomotion/geometry/so3.h"
#include "multicam_egomotion/odometry/rig_calibration.h"

namespace multicam_egomotion {
namespace {

struct Placed {
  double yaw;  // from body x to the left [rad]
  Eigen::Vector3d position;
};

RigCamera cameraAt(const Placed& placed, const CameraSigmas& sigmas) {
  Eigen::Matrix3d R_forward_optical;
  R_forward_optical << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  RigCamera camera{"cam", "cam", CameraModel(640, 480, 400, 400, 320, 240, Distortion::kNone, {}),
                   Eigen::Isometry3d::Identity()};
  camera.T_body_cam.linear() = expSO3({0.0, 0.0, placed.yaw}) * R_forward_optical;
  camera.T_body_cam.translation() = placed.position;
  camera.sigmas = sigmas;
  return camera;
}

CameraRig rigOf(const std::vector<Placed>& cameras, const CameraSigmas& sigmas = {}) {
  std::vector<RigCamera> all;
  for (const Placed& one : cameras) {
    all.push_back(cameraAt(one, sigmas));
    all.back().name = all.back().frame_id = "cam" + std::to_string(all.size());
  }
  return CameraRig(all);
}

// Looks forward, 12 cm apart.
const std::vector<Placed> kStereo = {{0.0, {0.1, 0.06, 0.0}}, {0.0, {0.1, -0.06, 0.0}}};
// Looks forward and back, 2 m apart.
const std::vector<Placed> kBackToBack = {{0.0, {1.0, 0.0, 1.0}}, {M_PI, {-1.0, 0.0, 1.0}}};

TEST(RigCalibration, LengthsAreAsWellKnownAsTheDistanceOfTheCamerasThatOverlap) {
  EXPECT_NEAR(RigCalibration(rigOf(kStereo), true).lengthSigma(), 0.002 / 0.12, 1e-12);
  // Of the pairs that overlap the best counts. The second and third are further apart, but neither is exact.
  std::vector<Placed> cameras = kStereo;
  cameras.push_back({0.0, {0.1, 0.46, 0.0}});
  EXPECT_NEAR(RigCalibration(rigOf(cameras), true).lengthSigma(), 0.002 / 0.40, 1e-12);
  // A pair that does not overlap shows the length less well than one that does.
  cameras = kStereo;
  cameras.push_back({M_PI, {-1.0, 0.0, 0.0}});
  EXPECT_NEAR(RigCalibration(rigOf(cameras), true).lengthSigma(), 0.002 / 0.12, 1e-12);
}

TEST(RigCalibration, WithoutOverlapTheLargestDistanceCounts) {
  EXPECT_NEAR(RigCalibration(rigOf(kBackToBack), true).lengthSigma(), 0.001, 1e-12);
  std::vector<Placed> cameras = kBackToBack;
  cameras.push_back({0.5 * M_PI, {1.0, 0.5, 1.0}});
  // 2.06 m between the second and the third, of which neither is exact.
  EXPECT_NEAR(RigCalibration(rigOf(cameras), true).lengthSigma(), 0.001, 1e-12);
}

TEST(RigCalibration, ALengthThatIsNotKnownAtAllHasTheSigmaOne) {
  CameraSigmas sigmas;
  sigmas.position = 0.2;
  EXPECT_EQ(RigCalibration(rigOf(kStereo, sigmas), true).lengthSigma(), 1.0);
  // One camera knows no length in any case.
  EXPECT_EQ(RigCalibration(rigOf({kStereo[0]}), true).lengthSigma(), 0.0);
}

TEST(RigCalibration, ExactSigmasLeaveNothingToEstimate) {
  const CameraSigmas exact = {0.0, 0.0, 0.0, 0.0, 0.0, 0.0};
  const RigCalibration calibration(rigOf(kStereo, exact), true);
  EXPECT_EQ(calibration.lengthSigma(), 0.0);
  ASSERT_EQ(calibration.prior().calibration.size(), 2);  // the focal lengths, considered
  EXPECT_EQ(calibration.prior().calibration.considered(), (std::vector<int>{0, 1}));
  EXPECT_LT(calibration.consideredVariances().maxCoeff(), 1e-10);
  EXPECT_TRUE(calibration.prior().H.isZero());
  EXPECT_EQ(RigCalibration().prior().calibration.size(), 0);
  EXPECT_EQ(RigCalibration().lengthSigma(), 0.0);
}

TEST(RigCalibration, EachCameraGetsWhatItsImagesCanShow) {
  // A pair, and two that overlap with none.
  const CameraRig cameras = rigOf({kStereo[0], kStereo[1], {M_PI, {-1.0, 0.0, 0.0}}, {0.5 * M_PI, {0.0, 0.5, 0.0}}});
  const RigCalibration rig(cameras, true);
  const BundleCalibration& calibration = rig.prior().calibration;
  EXPECT_EQ(calibration.correction(0)->parameters(), 1);
  EXPECT_EQ(calibration.correction(1)->parameters(), CameraCorrection::kAll);
  for (int k : {2, 3}) {
    EXPECT_TRUE(calibration.correction(k)->turns);
    EXPECT_FALSE(calibration.correction(k)->has_field);
  }
  const std::vector<int> focal_lengths = {0, calibration.correction(2)->focalColumn(),
                                          calibration.correction(3)->focalColumn()};
  EXPECT_EQ(calibration.considered(), focal_lengths);

  // Sigmas of the rig file; a focal length that is estimated is that against the other camera's.
  const auto rotation = [&](int k) {  // a shifted principal point looks like a turn
    return std::hypot(0.1 * M_PI / 180.0, 0.5 / cameras.camera(k).model.focalLength());
  };
  const Eigen::VectorXd variances = rig.priorCovariance().diagonal();
  EXPECT_NEAR(std::sqrt(variances[calibration.correction(1)->column]), rotation(1), 1e-12);
  EXPECT_NEAR(std::sqrt(variances[calibration.correction(3)->column + 2]), rotation(3), 1e-12);
  EXPECT_NEAR(std::sqrt(variances[calibration.correction(1)->focalColumn()]), std::hypot(0.002, 0.002), 1e-12);
  EXPECT_NEAR(std::sqrt(variances[calibration.correction(1)->focalColumn() + 1]), 0.5, 1e-12);
  ASSERT_EQ(rig.consideredVariances().size(), 3);
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(std::sqrt(rig.consideredVariances()[i]), 0.002, 1e-12);
    EXPECT_EQ(rig.prior().H.row(focal_lengths[i]).norm(), 0.0);
  }
  const int first = calibration.correction(1)->column;
  EXPECT_NEAR(rig.prior().H(first, first), 1.0 / (rotation(1) * rotation(1)), 1e-3);
}

TEST(RigCalibration, WithoutEstimationAllIsConsidered) {
  const RigCalibration rig(rigOf(kStereo), false);
  const BundleCalibration& calibration = rig.prior().calibration;
  EXPECT_EQ(calibration.size(), 1 + CameraCorrection::kAll);
  EXPECT_EQ(static_cast<int>(calibration.considered().size()), calibration.size());
  EXPECT_EQ(rig.consideredVariances(), rig.priorCovariance().diagonal());
  EXPECT_TRUE(rig.prior().H.isZero());
  EXPECT_NEAR(rig.lengthSigma(), 0.002 / 0.12, 1e-12);
}

FeatureObservation featureAt(int camera, const Eigen::Vector2d& pixel) {
  FeatureObservation feature;
  feature.camera = camera;
  feature.pixel = pixel;
  feature.bearing = Eigen::Vector3d((pixel.x() - 320) / 400, (pixel.y() - 240) / 400, 1.0).normalized();
  feature.to_pixel << 400, 0, -400 * (pixel.x() - 320) / 400, 0, 400, -400 * (pixel.y() - 240) / 400;
  feature.to_pixel *= feature.bearing.z();
  return feature;
}

TEST(RigCalibration, TheFieldRunsAcrossTheEpipolarLines) {
  // Beside each other the lines run along x of the image, above each other along y.
  const std::vector<Placed> above = {{0.0, {0.1, 0.0, 0.06}}, {0.0, {0.1, 0.0, -0.06}}};
  for (const bool upright : {false, true}) {
    const CameraRig rig = rigOf(upright ? above : kStereo);
    const RigCalibration calibration(rig, true);
    const FeatureObservation feature = featureAt(1, {479.5, 299.5});
    BundleObservation view;
    view.center = rig.camera(1).T_body_cam.translation();
    calibration.place(feature, rig.camera(1).T_body_cam, &view);
    EXPECT_EQ(view.from_center, Eigen::Vector2d(159.5, 59.5));
    const Eigen::Vector2d across = upright ? Eigen::Vector2d(1.0, 0.0) : Eigen::Vector2d(0.0, 1.0);
    EXPECT_NEAR(std::abs(view.across.dot(across)), 1.0, 1e-9);
    const Eigen::Vector2d along_across = upright ? Eigen::Vector2d(0.25, 0.5) : Eigen::Vector2d(0.5, 0.25);
    EXPECT_LT((view.image_position - along_across).norm(), 1e-12);

    BundleObservation first;
    first.center = rig.camera(0).T_body_cam.translation();
    calibration.place(featureAt(0, {479.5, 299.5}), rig.camera(0).T_body_cam, &first);
    EXPECT_TRUE(first.across.isZero());
    EXPECT_EQ(first.from_center, Eigen::Vector2d(159.5, 59.5));
  }
}

}  // namespace
}  // namespace multicam_egomotion
