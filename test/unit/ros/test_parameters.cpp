// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <fstream>

#include "multicam_egomotion/ros/parameters.h"

namespace multicam_egomotion {
namespace {

std::string text(XmlRpc::XmlRpcValue value) {
  std::ostringstream stream;
  stream << value.getType() << ' ';
  value.write(stream);  // its operator<< is hidden by those of our messages
  return stream.str();
}

std::string refusal(const ParameterMap& values) {
  Parameters parameters;
  try {
    applyParameters(values, &parameters);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(Parameters, ConfigFileHoldsAllDefaults) {
  const ParameterMap file = readParameterFile("config/egomotion.yaml");
  const ParameterMap defaults = parameterValues(Parameters());
  for (const auto& [name, value] : defaults) {
    ASSERT_EQ(file.count(name), 1u) << name << " is not in config/egomotion.yaml";
    EXPECT_EQ(text(file.at(name)), text(value)) << name;
  }
  for (const auto& entry : file) EXPECT_EQ(defaults.count(entry.first), 1u) << entry.first << " is no parameter";
}

TEST(Parameters, ValuesArriveAndIntegersServeAsNumbers) {
  Parameters parameters;
  ParameterMap values;
  values["max_coast_s"] = 3;
  values["tracker/features_per_camera"] = 77;
  values["use_imu"] = false;
  values["solver"] = std::string("4pt-axis");
  EXPECT_TRUE(applyParameters(values, &parameters).empty());
  EXPECT_EQ(parameters.odometry.max_coast_s, 3.0);
  EXPECT_EQ(parameters.odometry.tracker.features_per_camera, 77);
  EXPECT_FALSE(parameters.odometry.use_imu);
  EXPECT_EQ(parameters.odometry.solver, "4pt-axis");
}

TEST(Parameters, RefusalsNameParameterFoundAndExpected) {
  EXPECT_EQ(refusal({{"use_imu", 1}}), "parameter 'use_imu': found 1, expected true or false");
  EXPECT_EQ(refusal({{"cameras", 9}}), "parameter 'cameras': found 9, expected an integer in [1, 8]");
  EXPECT_EQ(refusal({{"cameras", 2.5}}), "parameter 'cameras': found 2.5, expected an integer in [1, 8]");
  EXPECT_EQ(refusal({{"solver", std::string("8pt")}}),
            "parameter 'solver': found '8pt', expected one of auto, 4pt-vertical, 4pt-axis");
  EXPECT_NE(refusal({{"max_coast_s", std::string("1e-3")}}).find("write 1.0e-3"), std::string::npos);
  EXPECT_NE(refusal({{"max_coast_s", std::nan("")}}), "");
}

TEST(Parameters, UnknownNamesAreAnswered) {
  Parameters parameters;
  const auto unknown = applyParameters({{"tracker/feature_per_camera", 1}}, &parameters);
  ASSERT_EQ(unknown.size(), 1u);
  EXPECT_EQ(unknown[0], "tracker/feature_per_camera");
}

TEST(Parameters, FilesMayBePartialAndAreTypedAsByRoslaunch) {
  const std::string path = ::testing::TempDir() + "partial.yaml";
  std::ofstream(path) << "use_imu: false\nodom_frame: '7'\ntracker: {min_distance_px: 9}\nmask_files: [a.png, '']\n";
  Parameters parameters;
  EXPECT_TRUE(applyParameters(readParameterFile(path), &parameters).empty());
  EXPECT_FALSE(parameters.odometry.use_imu);
  EXPECT_EQ(parameters.node.odom_frame, "7");
  EXPECT_EQ(parameters.odometry.tracker.min_distance_px, 9);
  EXPECT_EQ(parameters.node.mask_files, (std::vector<std::string>{"a.png", ""}));
  EXPECT_THROW(readParameterFile("/does/not/exist.yaml"), std::invalid_argument);
}

TEST(Parameters, AliasesWithoutEndAreRefused) {
  const std::string path = ::testing::TempDir() + "aliases.yaml";
  std::ofstream(path) << "a: &a {b: *a}\n";
  EXPECT_THROW(readParameterFile(path), std::invalid_argument);
}

}  // namespace
}  // namespace multicam_egomotion
