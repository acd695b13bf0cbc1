// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <opencv2/calib3d.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "multicam_egomotion/geometry/camera_model.h"

namespace multicam_egomotion {
namespace {

struct NamedModel {
  std::string name;
  CameraModel model;
};

const std::vector<NamedModel>& models() {
  static const std::vector<NamedModel> all = {
      {"pinhole", {1241, 376, 718.856, 718.856, 607.19, 185.22, Distortion::kNone, {}}},
      {"radtan_euroc",
       {752,
        480,
        458.654,
        457.296,
        367.215,
        248.375,
        Distortion::kRadtan,
        {-0.28340811, 0.07395907, 0.00019359, 1.76187114e-05}}},
      {"radtan_kitti_raw",
       {1392,
        512,
        984.2439,
        980.8141,
        690.0,
        233.1966,
        Distortion::kRadtan,
        {-0.3728755, 0.2037299, 0.002219027, 0.001383707, -0.07233722}}},
      {"radtan_pincushion", {640, 480, 500, 505, 320, 240, Distortion::kRadtan, {0.3, 0.2, -0.002, 0.003, 0.1}}},
      {"rational_wide",
       {1280,
        720,
        605.3,
        605.1,
        637.7,
        366.6,
        Distortion::kRationalPolynomial,
        {0.572, -2.718, 0.000712, -0.000297, 1.565, 0.451, -2.541, 1.491}}},
      {"rational_120_degrees",
       {1920,
        1080,
        560.0,
        560.0,
        960.0,
        540.0,
        Distortion::kRationalPolynomial,
        {1.9, 0.42, 0.0002, -0.0001, 0.012, 2.25, 0.92, 0.083}}},
      {"equidistant_tum_vi",
       {512,
        512,
        190.978,
        190.973,
        254.932,
        256.897,
        Distortion::kEquidistant,
        {0.0034823894, 0.0007150348, -0.0020532361, 0.00020293673}}},
      {"equidistant_200_degrees",
       {1000, 1000, 286, 286, 499.5, 499.5, Distortion::kEquidistant, {-0.01, 0.002, -0.0002, 1e-5}}},
  };
  return all;
}

class EachModel : public testing::TestWithParam<std::size_t> {
 protected:
  const CameraModel& model() const { return models()[GetParam()].model; }

  // Calls visit(pixel, bearing) on a grid over the image, border included; returns the share that could be inverted.
  template <typename Visit>
  double overTheImage(Visit visit) const {
    constexpr int kSteps = 60;
    int valid = 0, all = 0;
    for (int row = 0; row <= kSteps; ++row) {
      for (int column = 0; column <= kSteps; ++column, ++all) {
        const Eigen::Vector2d pixel((model().width() - 1.0) * column / kSteps, (model().height() - 1.0) * row / kSteps);
        Eigen::Vector3d bearing;
        if (!model().unproject(pixel, &bearing)) continue;
        ++valid;
        visit(pixel, bearing);
      }
    }
    return static_cast<double>(valid) / all;
  }
};

TEST_P(EachModel, RoundTripsOverTheWholeImage) {
  double worst = 0, worst_norm = 0;
  const double share = overTheImage([&](const Eigen::Vector2d& pixel, const Eigen::Vector3d& bearing) {
    Eigen::Vector2d back;
    ASSERT_TRUE(model().project(3.7 * bearing, &back)) << pixel.transpose();
    worst = std::max(worst, (back - pixel).norm());
    worst_norm = std::max(worst_norm, std::abs(bearing.norm() - 1));
  });
  EXPECT_EQ(share, 1.0);
  EXPECT_LT(worst, 1e-10);
  EXPECT_LT(worst_norm, 1e-15);
}

TEST_P(EachModel, BearingJacobianAgreesWithCentralDifferences) {
  constexpr double kStep = 1e-3;
  overTheImage([&](const Eigen::Vector2d& pixel, const Eigen::Vector3d&) {
    Eigen::Vector3d bearing;
    Eigen::Matrix<double, 3, 2> analytic, numeric;
    ASSERT_TRUE(model().unproject(pixel, &bearing, &analytic));
    for (int i = 0; i < 2; ++i) {
      const Eigen::Vector2d d = kStep * Eigen::Vector2d::Unit(i);
      Eigen::Vector3d plus, minus;
      ASSERT_TRUE(model().unproject(pixel + d, &plus) && model().unproject(pixel - d, &minus));
      numeric.col(i) = (plus - minus) / (2 * kStep);
    }
    ASSERT_LT((analytic - numeric).norm(), 1e-7 * analytic.norm()) << pixel.transpose();
  });
}

TEST_P(EachModel, PixelJacobianAgreesWithCentralDifferences) {
  constexpr double kStep = 1e-5;
  overTheImage([&](const Eigen::Vector2d& pixel, const Eigen::Vector3d& bearing) {
    const Eigen::Vector3d point = 2.5 * bearing;
    Eigen::Vector2d back;
    Eigen::Matrix<double, 2, 3> analytic, numeric;
    ASSERT_TRUE(model().project(point, &back, &analytic));
    for (int i = 0; i < 3; ++i) {
      const Eigen::Vector3d d = kStep * Eigen::Vector3d::Unit(i);
      Eigen::Vector2d plus, minus;
      ASSERT_TRUE(model().project(point + d, &plus) && model().project(point - d, &minus));
      numeric.col(i) = (plus - minus) / (2 * kStep);
    }
    ASSERT_LT((analytic - numeric).norm(), 1e-6 * analytic.norm()) << pixel.transpose();
  });
}

TEST_P(EachModel, AgreesWithOpenCv) {
  const CameraModel& m = model();
  const cv::Matx33d K(m.fx(), 0, m.cx(), 0, m.fy(), m.cy(), 0, 0, 1);
  std::vector<double> coefficients = m.coefficients();
  std::vector<cv::Point3d> points;
  std::vector<Eigen::Vector2d> pixels;
  overTheImage([&](const Eigen::Vector2d& pixel, const Eigen::Vector3d& bearing) {
    if (bearing.z() < 0.02) return;  // OpenCV's fisheye sees the front half space only
    points.emplace_back(2 * bearing.x(), 2 * bearing.y(), 2 * bearing.z());
    pixels.push_back(pixel);
  });
  ASSERT_GT(points.size(), 1000u);
  std::vector<cv::Point2d> projected;
  const cv::Vec3d zero(0, 0, 0);
  if (m.distortion() == Distortion::kEquidistant) {
    cv::fisheye::projectPoints(points, projected, zero, zero, K, coefficients);
  } else {
    cv::projectPoints(points, zero, zero, K, coefficients, projected);
  }
  double worst = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    worst = std::max(worst, std::hypot(projected[i].x - pixels[i].x(), projected[i].y - pixels[i].y()));
  }
  EXPECT_LT(worst, 1e-8);
}

TEST_P(EachModel, RefusesWhatIsNotInView) {
  Eigen::Vector2d pixel;
  Eigen::Vector3d bearing;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(model().project(Eigen::Vector3d(0, 0, -1), &pixel));
  EXPECT_FALSE(model().project(Eigen::Vector3d::Zero(), &pixel));
  EXPECT_FALSE(model().project(Eigen::Vector3d(nan, 0, 1), &pixel));
  EXPECT_FALSE(model().unproject(Eigen::Vector2d(nan, 0), &bearing));
  EXPECT_FALSE(model().unproject(Eigen::Vector2d(0, std::numeric_limits<double>::infinity()), &bearing));
}

TEST_P(EachModel, ThePrincipalPointLooksForward) {
  Eigen::Vector3d bearing;
  Eigen::Vector2d pixel;
  Eigen::Matrix<double, 3, 2> d_bearing;
  Eigen::Matrix<double, 2, 3> d_pixel;
  ASSERT_TRUE(model().unproject({model().cx(), model().cy()}, &bearing, &d_bearing));
  EXPECT_LT((bearing - Eigen::Vector3d::UnitZ()).norm(), 1e-15);
  ASSERT_TRUE(model().project(bearing, &pixel, &d_pixel));
  EXPECT_LT((d_pixel * d_bearing - Eigen::Matrix2d::Identity()).norm(), 1e-12);
}

INSTANTIATE_TEST_SUITE_P(Models, EachModel, testing::Range<std::size_t>(0, models().size()),
                         [](const auto& info) { return models()[info.param].name; });

TEST(CameraModel, FisheyeSeesBehindTheImagePlane) {
  const CameraModel& fisheye = models().back().model;
  const double angle = 99 * M_PI / 180;
  Eigen::Vector2d pixel;
  Eigen::Vector3d bearing;
  const Eigen::Vector3d behind(std::sin(angle), 0, std::cos(angle));
  ASSERT_TRUE(fisheye.project(behind, &pixel));
  EXPECT_TRUE(fisheye.contains(pixel));
  ASSERT_TRUE(fisheye.unproject(pixel, &bearing));
  EXPECT_LT((bearing - behind).norm(), 1e-13);
}

// r (1 - r^2) turns back at r = 1/sqrt(3): points beyond must not fold into the image.
TEST(CameraModel, StopsWhereTheDistortionTurnsBack) {
  const CameraModel model(640, 480, 600, 600, 320, 240, Distortion::kRadtan, {-1.0});
  const double turn = 1 / std::sqrt(3.0);
  Eigen::Vector2d pixel;
  EXPECT_TRUE(model.project({0.999 * turn, 0, 1}, &pixel));
  EXPECT_FALSE(model.project({1.001 * turn, 0, 1}, &pixel));
  Eigen::Vector3d bearing;
  const double largest = 600 * turn * (1 - turn * turn);
  ASSERT_TRUE(model.unproject({320 + 0.999 * largest, 240}, &bearing));
  ASSERT_TRUE(model.project(bearing, &pixel));
  EXPECT_NEAR(pixel.x(), 320 + 0.999 * largest, 1e-10);
  EXPECT_FALSE(model.unproject({320 + 1.001 * largest, 240}, &bearing));
  EXPECT_FALSE(model.unproject({1e6, 240}, &bearing));
}

TEST(CameraModel, FisheyeStopsWhereTheDistortionTurnsBack) {
  const CameraModel model(640, 640, 200, 200, 320, 320, Distortion::kEquidistant, {-0.1});
  const double turn = std::sqrt(1 / 0.3);  // 1 - 0.3 theta^2 = 0: 104.6 deg
  Eigen::Vector2d pixel;
  Eigen::Vector3d bearing;
  EXPECT_TRUE(model.project({std::sin(turn - 1e-3), 0, std::cos(turn - 1e-3)}, &pixel));
  EXPECT_FALSE(model.project({std::sin(turn + 1e-3), 0, std::cos(turn + 1e-3)}, &pixel));
  const double largest = 200 * turn * (1 - 0.1 * turn * turn);
  EXPECT_TRUE(model.unproject({320 + largest - 1e-3, 320}, &bearing));
  EXPECT_FALSE(model.unproject({320 + largest + 1e-3, 320}, &bearing));
}

TEST(CameraModel, ContainsRespectsTheBorder) {
  const CameraModel& model = models()[1].model;
  EXPECT_TRUE(model.contains({0, 0}));
  EXPECT_TRUE(model.contains({751, 479}));
  EXPECT_FALSE(model.contains({751.01, 100}));
  EXPECT_FALSE(model.contains({9.9, 100}, 10));
  EXPECT_FALSE(model.contains({std::numeric_limits<double>::quiet_NaN(), 100}));
}

// The message names what was wrong and shows what was found.
void expectRefusal(int width, int height, double fx, double fy, double cx, double cy, Distortion distortion,
                   const std::vector<double>& coefficients, const std::string& name, const std::string& found) {
  try {
    CameraModel(width, height, fx, fy, cx, cy, distortion, coefficients);
    ADD_FAILURE() << "accepted: " << name;
  } catch (const std::invalid_argument& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find(name), std::string::npos) << text;
    EXPECT_NE(text.find(found), std::string::npos) << text;
    EXPECT_NE(text.find("expected"), std::string::npos) << text;
  }
}

TEST(CameraModel, InvalidParametersThrowWithAMessage) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  expectRefusal(0, 480, 450, 450, 320, 240, Distortion::kNone, {}, "width", "0");
  expectRefusal(640, -3, 450, 450, 320, 240, Distortion::kNone, {}, "height", "-3");
  expectRefusal(640, 480, 0, 450, 320, 240, Distortion::kNone, {}, "fx", "0");
  expectRefusal(640, 480, 450, -1, 320, 240, Distortion::kNone, {}, "fy", "-1");
  expectRefusal(640, 480, 450, 450, nan, 240, Distortion::kNone, {}, "cx", "nan");
  expectRefusal(640, 480, 450, 450, 320, nan, Distortion::kNone, {}, "cy", "nan");
  expectRefusal(640, 480, 450, 450, 320, 240, Distortion::kNone, {0.1}, "number of distortion coefficients", "1");
  expectRefusal(640, 480, 450, 450, 320, 240, Distortion::kEquidistant, {0, 0, 0, 0, 0.1}, "coefficients", "5");
  expectRefusal(640, 480, 450, 450, 320, 240, Distortion::kRadtan, {0.1, nan}, "coefficient 1", "nan");
  expectRefusal(640, 480, 450, 450, 320, 240, Distortion::kRadtan, {-200}, "can be inverted", "px");
}

TEST(CameraModel, DistortionNames) {
  EXPECT_EQ(distortionFromName("none"), Distortion::kNone);
  EXPECT_EQ(distortionFromName("plumb_bob"), Distortion::kRadtan);
  EXPECT_EQ(distortionFromName("radtan"), Distortion::kRadtan);
  EXPECT_EQ(distortionFromName("rational_polynomial"), Distortion::kRationalPolynomial);
  EXPECT_EQ(distortionFromName("fisheye"), Distortion::kEquidistant);
  EXPECT_EQ(distortionFromName("equidistant"), Distortion::kEquidistant);
  EXPECT_THROW(distortionFromName("fov"), std::invalid_argument);
}

}  // namespace
}  // namespace multicam_egomotion
