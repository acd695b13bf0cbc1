// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "multicam_egomotion/geometry/so3.h"

namespace multicam_egomotion {
namespace {

constexpr double kPi = 3.14159265358979323846;

class RandomVectors {
 public:
  Eigen::Vector3d direction() {
    return Eigen::Vector3d(normal_(generator_), normal_(generator_), normal_(generator_)).normalized();
  }

 private:
  std::mt19937 generator_{7};
  std::normal_distribution<double> normal_;
};

const std::vector<double> kAngles = {0.0,   1e-14, 1e-10, 1e-7, 1e-4, 0.05, 0.099,      0.101,
                                     0.299, 0.31,  1.0,   2.0,  3.0,  3.14, kPi - 1e-5, kPi - 1e-9};

TEST(So3, ExpIsARotationAndAgreesWithAngleAxis) {
  RandomVectors random;
  for (const double angle : kAngles) {
    const Eigen::Vector3d axis = random.direction();
    const Eigen::Matrix3d R = expSO3(angle * axis);
    EXPECT_LT((R - Eigen::AngleAxisd(angle, axis).toRotationMatrix()).norm(), 2e-15) << angle;
    EXPECT_LT((R.transpose() * R - Eigen::Matrix3d::Identity()).norm(), 3e-15) << angle;
  }
}

TEST(So3, LogInvertsExpToMachinePrecisionFromZeroToPi) {
  RandomVectors random;
  for (const double angle : kAngles) {
    for (int trial = 0; trial < 100; ++trial) {
      const Eigen::Vector3d v = angle * random.direction();
      const Eigen::Vector3d back = logSO3(expSO3(v));
      // exp itself rounds to 1e-16 per entry, which is the error of the angle.
      EXPECT_LT((back - v).norm(), 3e-15) << angle;
    }
  }
}

TEST(So3, LogOfAHalfTurnHasNormPi) {
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::Vector3d v = kPi * Eigen::Vector3d::Unit(axis);
    const Eigen::Vector3d back = logSO3(Eigen::AngleAxisd(kPi, Eigen::Vector3d::Unit(axis)).toRotationMatrix());
    EXPECT_LT(std::min((back - v).norm(), (back + v).norm()), 1e-15);
  }
}

TEST(So3, LogKeepsRelativePrecisionOfTinyAngles) {
  const Eigen::Vector3d v(3e-11, -4e-11, 1e-11);
  EXPECT_LT((logSO3(expSO3(v)) - v).norm(), 1e-15 * v.norm() + 1e-25);
}

TEST(So3, RightJacobianAgreesWithCentralDifferences) {
  RandomVectors random;
  constexpr double kStep = 1e-5;
  for (const double angle : kAngles) {
    const Eigen::Vector3d v = angle * random.direction();
    Eigen::Matrix3d numeric;
    for (int i = 0; i < 3; ++i) {
      const Eigen::Vector3d d = kStep * Eigen::Vector3d::Unit(i);
      numeric.col(i) =
          (logSO3(expSO3(v).transpose() * expSO3(v + d)) - logSO3(expSO3(v).transpose() * expSO3(v - d))) / (2 * kStep);
    }
    EXPECT_LT((numeric - rightJacobianSO3(v)).norm(), 1e-9) << angle;
  }
}

TEST(So3, InverseRightJacobianIsTheInverse) {
  RandomVectors random;
  for (const double angle : kAngles) {
    const Eigen::Vector3d v = angle * random.direction();
    const Eigen::Matrix3d product = rightJacobianSO3(v) * inverseRightJacobianSO3(v);
    EXPECT_LT((product - Eigen::Matrix3d::Identity()).norm(), 1e-12) << angle;
  }
}

TEST(So3, SkewIsTheCrossProduct) {
  const Eigen::Vector3d a(1, 2, 3), b(-4, 5, 7);
  EXPECT_EQ(skew(a) * b, a.cross(b));
}

}  // namespace
}  // namespace multicam_egomotion
