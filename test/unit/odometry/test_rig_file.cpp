// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cstdio>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "multicam_egomotion/odometry/rig_file.h"

namespace multicam_egomotion {
namespace {

const char kOwn[] = R"(# rig of multicam_egomotion
body_frame: base_link
cameras:
  - name: front
    frame_id: front_optical
    image_topic: /front/image_raw
    camera_info_topic: /front/camera_info
    model: pinhole
    resolution: [752, 480]
    intrinsics: [458.654, 457.296, 367.215, 248.375]
    distortion_model: radtan
    distortion: [-0.28340811, 0.07395907, 0.00019359, 1.76187114e-05]
    T_body_cam:
      - [0, 0, 1, 0.5]
      - [-1, 0, 0, 0.1]
      - [0, -1, 0, 1.2]
      - [0, 0, 0, 1]
    time_offset_s: 0.004
    sigmas:
      rotation_deg: 0.07
      position_m: 0.0005
      focal_length_percent: 0.3
      principal_point_px: 0.9
      distortion_px: 0
      time_offset_s: 1e-4
  - name: down
    model: equidistant
    resolution: [512, 512]
    intrinsics: [190.978, 190.973, 254.932, 256.897]
    distortion: [0.0034, 0.0007, -0.002, 0.0002]
    T_body_cam: [1, 0, 0, 0,  0, -1, 0, 0,  0, 0, -1, -0.3,  0, 0, 0, 1]
imu:
  frame_id: imu_link
  topic: /imu/data
  T_body_imu: [[1, 0, 0, 0.1], [0, 1, 0, 0.2], [0, 0, 1, 0.3], [0, 0, 0, 1]]
  rate_hz: 400
  gyroscope_noise_density: 1.7e-4
  gyroscope_random_walk: 1.9e-5
  accelerometer_noise_density: 2.0e-3
  accelerometer_random_walk: 3.0e-3
  mounting_sigma_deg: 0.4
)";

// As kalibr_calibrate_imu_camera writes it.
const char kKalibr[] = R"(cam0:
  T_cam_imu:
  - [0.01486554298179427, 0.9995572490083462, -0.025774436697440185, 0.06522290953553112]
  - [-0.9998809296985752, 0.014967213324719115, 0.003756188357967003, -0.020706385492719275]
  - [0.0041402965794923094, 0.025715529947965886, 0.9996607271779023, -0.008054602460030274]
  - [0.0, 0.0, 0.0, 1.0]
  cam_overlaps: [1]
  camera_model: pinhole
  distortion_coeffs: [-0.28340811, 0.07395907, 0.00019359, 1.76187114e-05]
  distortion_model: radtan
  intrinsics: [458.654, 457.296, 367.215, 248.375]
  resolution: [752, 480]
  rostopic: /cam0/image_raw
  timeshift_cam_imu: -0.0021
cam1:
  T_cn_cnm1:
  - [0.9999972564777852, 0.0023120672192366563, 0.0003760082346031085, -0.11007380681251156]
  - [-0.002317135723281765, 0.999898048506644, 0.014089835846648468, 0.000399121547014739]
  - [-0.00034339312041352556, -0.014090668452714162, 0.9999006626377255, -0.0008537025097786096]
  - [0.0, 0.0, 0.0, 1.0]
  cam_overlaps: [0]
  camera_model: pinhole
  distortion_coeffs: [0.0034, 0.0007, -0.002, 0.0002]
  distortion_model: equidistant
  intrinsics: [457.587, 456.134, 379.999, 255.238]
  resolution: [752, 480]
  rostopic: /cam1/image_raw
  timeshift_cam_imu: -0.0022
)";

const char kKalibrImu[] = R"(#Accelerometers
accelerometer_noise_density: 2.0e-3   #Noise density (continuous-time)
accelerometer_random_walk:   3.0e-3   #Bias random walk
#Gyroscopes
gyroscope_noise_density:     1.7e-4
gyroscope_random_walk:       1.9e-5
rostopic:                    /imu0
update_rate:                 200.0
)";

class RigFileTest : public testing::Test {
 protected:
  void TearDown() override {
    for (const std::string& path : written_) std::remove(path.c_str());
  }

  std::string path(const std::string& name) {
    written_.push_back(testing::TempDir() + testing::UnitTest::GetInstance()->current_test_info()->name() + "_" + name);
    return written_.back();
  }

  std::string write(const std::string& name, const std::string& content) {
    const std::string file = path(name);
    std::ofstream(file) << content;
    return file;
  }

  // The message names the file and each of `parts`.
  void expectRefusal(const std::string& content, const std::vector<std::string>& parts) {
    const std::string file = write("refused.yaml", content);
    try {
      loadRigFile(file);
      ADD_FAILURE() << "accepted, expected a refusal with " << parts.front();
    } catch (const std::runtime_error& error) {
      const std::string text = error.what();
      EXPECT_NE(text.find(file), std::string::npos) << text;
      for (const std::string& part : parts) EXPECT_NE(text.find(part), std::string::npos) << part << " in: " << text;
    }
  }

 private:
  std::vector<std::string> written_;
};

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t position = text.find(from);
  EXPECT_NE(position, std::string::npos) << from;
  return text.replace(position, from.size(), to);
}

void expectEqual(const CameraSigmas& a, const CameraSigmas& b) {
  EXPECT_DOUBLE_EQ(a.rotation, b.rotation);
  EXPECT_EQ(a.position, b.position);
  EXPECT_DOUBLE_EQ(a.focal_length, b.focal_length);
  EXPECT_EQ(a.principal_point_px, b.principal_point_px);
  EXPECT_EQ(a.distortion_px, b.distortion_px);
  EXPECT_EQ(a.time_offset_s, b.time_offset_s);
}

TEST_F(RigFileTest, LoadsOurOwnFormat) {
  const RigFile file = loadRigFile(write("rig.yaml", kOwn));
  ASSERT_EQ(file.rig.size(), 2);
  EXPECT_EQ(file.body_frame, "base_link");

  const RigCamera& front = file.rig.camera(0);
  EXPECT_EQ(front.name, "front");
  EXPECT_EQ(front.frame_id, "front_optical");
  EXPECT_EQ(front.model.width(), 752);
  EXPECT_EQ(front.model.height(), 480);
  EXPECT_EQ(front.model.fx(), 458.654);
  EXPECT_EQ(front.model.cy(), 248.375);
  EXPECT_EQ(front.model.distortion(), Distortion::kRadtan);
  EXPECT_EQ(front.model.coefficients().at(3), 1.76187114e-05);
  EXPECT_EQ(front.time_offset_s, 0.004);
  EXPECT_LT((front.T_body_cam * Eigen::Vector3d(0, 0, 2) - Eigen::Vector3d(2.5, 0.1, 1.2)).norm(), 1e-12);
  EXPECT_EQ(file.image_topics.at(0), "/front/image_raw");
  EXPECT_EQ(file.camera_info_topics.at(0), "/front/camera_info");

  const RigCamera& down = file.rig.camera(1);
  EXPECT_EQ(down.frame_id, "down");
  EXPECT_EQ(down.model.distortion(), Distortion::kEquidistant);
  EXPECT_EQ(down.time_offset_s, 0.0);
  EXPECT_LT((down.T_body_cam * Eigen::Vector3d(0, 0, 2) - Eigen::Vector3d(0, 0, -2.3)).norm(), 1e-12);
  EXPECT_EQ(file.image_topics.at(1), "");

  ASSERT_TRUE(file.has_imu);
  EXPECT_EQ(file.imu.frame_id, "imu_link");
  EXPECT_EQ(file.imu.topic, "/imu/data");
  EXPECT_EQ(file.imu.rate_hz, 400);
  EXPECT_EQ(file.imu.gyroscope_noise_density, 1.7e-4);
  EXPECT_EQ(file.imu.gyroscope_random_walk, 1.9e-5);
  EXPECT_EQ(file.imu.accelerometer_noise_density, 2.0e-3);
  EXPECT_EQ(file.imu.accelerometer_random_walk, 3.0e-3);
  EXPECT_LT((file.imu.T_body_imu.translation() - Eigen::Vector3d(0.1, 0.2, 0.3)).norm(), 1e-15);
}

TEST_F(RigFileTest, LoadsHowWellTheRigIsKnown) {
  const RigFile file = loadRigFile(write("rig.yaml", kOwn));
  const CameraSigmas& front = file.rig.camera(0).sigmas;
  EXPECT_DOUBLE_EQ(front.rotation, 0.07 * M_PI / 180.0);
  EXPECT_EQ(front.position, 0.0005);
  EXPECT_DOUBLE_EQ(front.focal_length, 0.003);
  EXPECT_EQ(front.principal_point_px, 0.9);
  EXPECT_EQ(front.distortion_px, 0.0);
  EXPECT_EQ(front.time_offset_s, 1e-4);
  expectEqual(file.rig.camera(1).sigmas, CameraSigmas());
  EXPECT_DOUBLE_EQ(file.imu.mounting_sigma, 0.4 * M_PI / 180.0);
}

TEST_F(RigFileTest, SigmasThatAreNotGivenAreTheDefaults) {
  std::string text = replaced(kOwn, "      position_m: 0.0005\n", "");
  text = replaced(text, "      distortion_px: 0\n", "");
  text = replaced(text, "  mounting_sigma_deg: 0.4\n", "");
  const RigFile file = loadRigFile(write("rig.yaml", text));
  EXPECT_EQ(file.rig.camera(0).sigmas.position, CameraSigmas().position);
  EXPECT_EQ(file.rig.camera(0).sigmas.distortion_px, CameraSigmas().distortion_px);
  EXPECT_EQ(file.rig.camera(0).sigmas.principal_point_px, 0.9);
  EXPECT_EQ(file.imu.mounting_sigma, ImuCalibration().mounting_sigma);
}

TEST_F(RigFileTest, SigmasThatCannotBeAreRefused) {
  const std::vector<std::pair<std::string, std::string>> sigmas = {
      {"rotation_deg: 0.07", "0 to 30"},        {"position_m: 0.0005", "0 to 10"},
      {"focal_length_percent: 0.3", "0 to 50"}, {"principal_point_px: 0.9", "0 to 500"},
      {"distortion_px: 0", "0 to 500"},         {"time_offset_s: 1e-4", "0 to 1"}};
  for (const auto& [line, range] : sigmas) {
    const std::string key = line.substr(0, line.find(':')), place = "cameras[0].sigmas." + key;
    expectRefusal(replaced(kOwn, line, key + ": -1e-6"), {place, "'-1e-6'", "a number from " + range});
    expectRefusal(replaced(kOwn, line, key + ": 501"), {place, "'501'", "a number from " + range});
    expectRefusal(replaced(kOwn, line, key + ": .nan"), {place, "'.nan'", "a finite number"});
    expectRefusal(replaced(kOwn, line, key + ": little"), {place, "'little'", "a finite number"});
  }
  expectRefusal(replaced(kOwn, "rotation_deg", "rotation"), {"cameras[0].sigmas", "'rotation'", "rotation_deg"});
  expectRefusal(replaced(kOwn, "mounting_sigma_deg: 0.4", "mounting_sigma_deg: -0.4"),
                {"imu.mounting_sigma_deg", "'-0.4'", "a number from 0 to 30"});
  expectRefusal(replaced(kOwn, "mounting_sigma_deg: 0.4", "mounting_sigma_deg: 31"),
                {"imu.mounting_sigma_deg", "'31'", "a number from 0 to 30"});
}

TEST_F(RigFileTest, TheImuIsOptional) {
  const std::string text(kOwn);
  EXPECT_FALSE(loadRigFile(write("rig.yaml", text.substr(0, text.find("imu:\n")))).has_imu);
}

TEST_F(RigFileTest, WrittenFilesReadBackTheSame) {
  const RigFile first = loadRigFile(write("rig.yaml", kOwn));
  const std::string copy = path("copy.yaml");
  writeRigFile(copy, first);
  const RigFile second = loadRigFile(copy);
  ASSERT_EQ(second.rig.size(), first.rig.size());
  for (int i = 0; i < first.rig.size(); ++i) {
    const RigCamera &a = first.rig.camera(i), &b = second.rig.camera(i);
    EXPECT_EQ(a.name, b.name);
    EXPECT_EQ(a.frame_id, b.frame_id);
    EXPECT_EQ(a.model.width(), b.model.width());
    EXPECT_EQ(a.model.height(), b.model.height());
    EXPECT_EQ(a.model.fx(), b.model.fx());
    EXPECT_EQ(a.model.fy(), b.model.fy());
    EXPECT_EQ(a.model.cx(), b.model.cx());
    EXPECT_EQ(a.model.cy(), b.model.cy());
    EXPECT_EQ(a.model.distortion(), b.model.distortion());
    EXPECT_EQ(a.model.coefficients(), b.model.coefficients());
    EXPECT_EQ(a.time_offset_s, b.time_offset_s);
    EXPECT_LT((a.T_body_cam.matrix() - b.T_body_cam.matrix()).norm(), 1e-14);
    expectEqual(a.sigmas, b.sigmas);
  }
  EXPECT_EQ(first.image_topics, second.image_topics);
  EXPECT_EQ(first.camera_info_topics, second.camera_info_topics);
  EXPECT_EQ(first.body_frame, second.body_frame);
  EXPECT_TRUE(second.has_imu);
  EXPECT_EQ(first.imu.frame_id, second.imu.frame_id);
  EXPECT_EQ(first.imu.topic, second.imu.topic);
  EXPECT_EQ(first.imu.rate_hz, second.imu.rate_hz);
  EXPECT_EQ(first.imu.gyroscope_noise_density, second.imu.gyroscope_noise_density);
  EXPECT_EQ(first.imu.gyroscope_random_walk, second.imu.gyroscope_random_walk);
  EXPECT_EQ(first.imu.accelerometer_noise_density, second.imu.accelerometer_noise_density);
  EXPECT_EQ(first.imu.accelerometer_random_walk, second.imu.accelerometer_random_walk);
  EXPECT_DOUBLE_EQ(first.imu.mounting_sigma, second.imu.mounting_sigma);
  EXPECT_LT((first.imu.T_body_imu.matrix() - second.imu.T_body_imu.matrix()).norm(), 1e-14);
}

TEST_F(RigFileTest, KeepsEveryModelAndOddNamesThroughARoundTrip) {
  std::vector<RigCamera> cameras;
  const std::vector<std::pair<Distortion, std::vector<double>>> models = {
      {Distortion::kNone, {}},
      {Distortion::kRadtan, {-0.28, 0.07, 1.0 / 3e4, 0, 0.01}},
      {Distortion::kRationalPolynomial, {0.572, -2.718, 0.0007, -0.0003, 1.565, 0.451, -2.541, 1.491}},
      {Distortion::kEquidistant, {0.003, 0.0007, -0.002, 0.0002}}};
  for (const auto& [distortion, coefficients] : models) {
    cameras.push_back(
        {"true: [#" + std::to_string(cameras.size()), "a b",
         CameraModel(640, 480, 400.1, 401.7, 320.3, 240.9, distortion, coefficients),
         Eigen::Isometry3d(Eigen::AngleAxisd(0.1 + cameras.size(), Eigen::Vector3d(1, 2, 3).normalized())), 1.0 / 3});
  }
  const std::vector<std::string> topics = {"/a", "", "no", "0"};
  const std::string written = path("rig.yaml");
  writeRigFile(written, {CameraRig(cameras), topics, topics, "robot/base", false, {}});
  const RigFile file = loadRigFile(written);
  ASSERT_EQ(file.rig.size(), 4);
  for (int i = 0; i < 4; ++i) {
    EXPECT_EQ(file.rig.camera(i).name, cameras[i].name);
    EXPECT_EQ(file.rig.camera(i).frame_id, "a b");
    EXPECT_EQ(file.rig.camera(i).model.distortion(), models[i].first);
    EXPECT_EQ(file.rig.camera(i).model.coefficients(), models[i].second);
    EXPECT_EQ(file.rig.camera(i).time_offset_s, 1.0 / 3);
    EXPECT_LT((file.rig.camera(i).T_body_cam.matrix() - cameras[i].T_body_cam.matrix()).norm(), 1e-14);
  }
  EXPECT_EQ(file.image_topics, topics);
  EXPECT_EQ(file.body_frame, "robot/base");
  EXPECT_FALSE(file.has_imu);
}

TEST_F(RigFileTest, LoadsKalibrAsItIs) {
  const RigFile file = loadRigFile(write("camchain-imucam.yaml", kKalibr), write("imu.yaml", kKalibrImu));
  ASSERT_EQ(file.rig.size(), 2);
  const RigCamera &cam0 = file.rig.camera(0), &cam1 = file.rig.camera(1);
  EXPECT_EQ(cam0.name, "cam0");
  EXPECT_EQ(cam0.time_offset_s, -0.0021);
  EXPECT_EQ(cam1.time_offset_s, -0.0022);
  expectEqual(cam1.sigmas, CameraSigmas());
  EXPECT_EQ(cam0.model.distortion(), Distortion::kRadtan);
  EXPECT_EQ(cam1.model.distortion(), Distortion::kEquidistant);
  EXPECT_EQ(file.image_topics, (std::vector<std::string>{"/cam0/image_raw", "/cam1/image_raw"}));
  // EuRoC's T_BS of cam0 is the inverse of T_cam_imu.
  EXPECT_LT(
      (cam0.T_body_cam.translation() - Eigen::Vector3d(-0.0216401454975, -0.064676986768, 0.00981073058949)).norm(),
      1e-6);
  // T_cn_cnm1 maps camera 0 into camera 1; the chain gives EuRoC's T_BS of cam1.
  EXPECT_LT(
      (cam1.T_body_cam.translation() - Eigen::Vector3d(-0.0198435579556, 0.0453689425024, 0.00786212447038)).norm(),
      1e-4);
  EXPECT_NEAR(file.rig.baseline(), 0.110, 1e-3);
  EXPECT_GT(file.rig.overlap(0, 1), 0.9);
  ASSERT_TRUE(file.has_imu);
  EXPECT_EQ(file.imu.topic, "/imu0");
  EXPECT_EQ(file.imu.rate_hz, 200.0);
  EXPECT_EQ(file.imu.gyroscope_noise_density, 1.7e-4);
  EXPECT_EQ(file.imu.accelerometer_random_walk, 3.0e-3);
  EXPECT_TRUE(file.imu.T_body_imu.isApprox(Eigen::Isometry3d::Identity()));
}

TEST_F(RigFileTest, LoadsTheImuFileThatKalibrReturns) {
  std::istringstream lines(kKalibrImu);
  std::string nested =
      "imu0:\n  T_i_b:\n  - [1.0, 0.0, 0.0, 0.0]\n  - [0.0, 1.0, 0.0, 0.0]\n  - [0.0, 0.0, 1.0, 0.0]\n"
      "  - [0.0, 0.0, 0.0, 1.0]\n  model: calibrated\n  time_offset: 0.0\n";
  for (std::string line; std::getline(lines, line);) nested += "  " + line + "\n";
  const RigFile file = loadRigFile(write("chain.yaml", kKalibr), write("imu.yaml", nested));
  EXPECT_EQ(file.imu.gyroscope_random_walk, 1.9e-5);
  EXPECT_EQ(file.imu.topic, "/imu0");
}

TEST_F(RigFileTest, KalibrWithoutImuFileHasDefaultNoise) {
  const RigFile file = loadRigFile(write("chain.yaml", kKalibr));
  EXPECT_TRUE(file.has_imu);
  EXPECT_EQ(file.imu.gyroscope_noise_density, ImuCalibration().gyroscope_noise_density);
}

TEST_F(RigFileTest, KalibrErrorsNameTheKey) {
  expectRefusal(replaced(kKalibr, "camera_model: pinhole", "camera_model: omni"),
                {"cam0.camera_model", "'omni'", "expected pinhole"});
  expectRefusal(replaced(kKalibr, "distortion_model: equidistant", "distortion_model: fov"),
                {"cam1.distortion_model", "'fov'", "expected radtan, equidistant or none"});
  expectRefusal(replaced(kKalibr, "T_cam_imu", "T_imu_cam"), {"cam0.T_cam_imu", "no such key"});
  expectRefusal(replaced(kKalibr, "resolution: [752, 480]", "resolution: [752]"),
                {"cam0.resolution", "a list of 1", "expected a list of 2"});
}

TEST_F(RigFileTest, FileErrors) {
  try {
    loadRigFile("/nowhere/rig.yaml");
    ADD_FAILURE();
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(error.what(), "/nowhere/rig.yaml: cannot be read or is empty, expected a YAML file");
  }
  expectRefusal("", {"empty"});
  expectRefusal("cameras: [", {"is not YAML"});
  expectRefusal("just a text", {"expected a YAML map"});
  expectRefusal("cameros: []", {"'cameras'", "camchain-imucam.yaml"});
  expectRefusal("cameras: []", {"cameras", "1 to 8"});
  EXPECT_THROW(writeRigFile("/nowhere/rig.yaml", loadRigFile(write("rig.yaml", kOwn))), std::runtime_error);
  EXPECT_THROW(loadRigFile(write("rig.yaml", kOwn), write("imu.yaml", kKalibrImu)), std::runtime_error);
}

TEST_F(RigFileTest, OwnFormatErrorsNameTheKey) {
  expectRefusal(replaced(kOwn, "time_offset_s", "time_offset"), {"cameras[0]", "'time_offset'", "time_offset_s"});
  expectRefusal(replaced(kOwn, "    intrinsics: [458.654, 457.296, 367.215, 248.375]\n", ""),
                {"cameras[0].intrinsics", "no such key"});
  expectRefusal(replaced(kOwn, "[458.654, 457.296, 367.215, 248.375]", "[458.654, 457.296, 367.215]"),
                {"cameras[0].intrinsics", "a list of 3", "a list of 4"});
  expectRefusal(replaced(kOwn, "[458.654,", "[fx,"), {"cameras[0].intrinsics[0]", "'fx'", "a finite number"});
  expectRefusal(replaced(kOwn, "[458.654,", "[-458.654,"), {"cameras[0]", "fx is -458.654", "positive"});
  expectRefusal(replaced(kOwn, "[752, 480]", "[752.5, 480]"), {"cameras[0].resolution", "whole numbers"});
  expectRefusal(replaced(kOwn, "distortion_model: radtan", "distortion_model: wobbly"),
                {"cameras[0].distortion_model", "wobbly", "rational_polynomial"});
  expectRefusal(replaced(kOwn, "model: pinhole", "model: mirror"), {"cameras[0].model", "'mirror'", "pinhole"});
  expectRefusal(replaced(kOwn, "[0, 0, 1, 0.5]", "[0, 0, 1.1, 0.5]"), {"cameras[0].T_body_cam", "not a rigid motion"});
  expectRefusal(replaced(kOwn, "[0, 0, 1, 0.5]", "[0, 0, -1, 0.5]"), {"cameras[0].T_body_cam", "not a rigid motion"});
  expectRefusal(replaced(kOwn, "      - [0, 0, 0, 1]\n", ""), {"cameras[0].T_body_cam", "list of 3", "4 rows of 4"});
  expectRefusal(replaced(kOwn, "[0, -1, 0, 1.2]", "[0, -1, 0, 1200]"), {"cameras", "'front'", "100 m"});
  expectRefusal(replaced(kOwn, "rate_hz: 400", "rate_hz: 0"), {"imu.rate_hz", "'0'", "positive"});
  expectRefusal(replaced(kOwn, "1.9e-5", "-1.9e-5"), {"imu.gyroscope_random_walk", "positive"});
  expectRefusal(replaced(kOwn, "[1, 0, 0, 0.1]", "[2, 0, 0, 0.1]"), {"imu.T_body_imu", "not a rigid motion"});
}

}  // namespace
}  // namespace multicam_egomotion
