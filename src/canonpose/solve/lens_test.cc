#include "canonpose/solve/lens.h"

#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "canonpose/geometry/camera.h"

namespace canonpose {
namespace {

const std::vector<RadialLens>& Lenses() {
  static const std::vector<RadialLens> lenses = {
      {{0.0, 0.0}},  {{-0.2, 0.06}}, {{-0.4, 0.12}}, {{-0.4, 0.0}},  // folds back
      {{0.15, 0.0}}, {{0.2, -0.08}}, {{-0.1, -0.1}}, {{1e-9, 0.0}}, {{0.0, -0.3}},
  };
  return lenses;
}

TEST(RadialLens, UndistortIsTheInverseAtEveryRadius) {
  const Eigen::Vector2d direction = Eigen::Vector2d(0.6, -0.8);
  for (const RadialLens& lens : Lenses()) {
    double before = -1.0;
    for (double radius = 0.0; radius < 3.0; radius += 0.01) {
      const Eigen::Vector2d distorted = lens.Distort(radius * direction);
      EXPECT_GT(distorted.dot(direction), before) << lens.at_corner[0] << " " << radius;
      before = distorted.dot(direction);
      EXPECT_LT((lens.Undistort(distorted) - radius * direction).norm(), 1e-12 * (1.0 + radius));
      EXPECT_LT((lens.Distort(lens.Undistort(radius * direction)) - radius * direction).norm(), 1e-12 * (1.0 + radius));
    }
  }
}

TEST(RadialLens, IsOpenCvsModel) {
  constexpr double kDiagonalPx = 1200.0;
  for (const RadialLens& lens : Lenses()) {
    for (const double focal : {0.6, 1.0, 2.5}) {
      Camera camera;
      camera.K << focal * kDiagonalPx, 0.0, 500.0, 0.0, focal * kDiagonalPx, 300.0, 0.0, 0.0, 1.0;
      camera.distortion = lens.OpenCv(focal);
      for (double radius = 0.0; radius < 0.3; radius += 0.02) {
        const Eigen::Vector2d undistorted = radius * Eigen::Vector2d(-0.8, 0.6);
        const Eigen::Vector2d pixel = camera.ProjectFromCamera({undistorted.x(), undistorted.y(), focal});
        const Eigen::Vector2d expected = kDiagonalPx * lens.Distort(undistorted) + Eigen::Vector2d(500.0, 300.0);
        EXPECT_LT((pixel - expected).norm(), 1e-9) << lens.at_corner[0] << " " << focal << " " << radius;
      }
    }
  }
}

TEST(RadialLens, CornerShiftIsWhatHappensInTheCorner) {
  const RadialLens lens{{-0.2, 0.06}};
  const Eigen::Vector2d corner = 0.5 * Eigen::Vector2d(0.8, 0.6);
  EXPECT_NEAR(lens.Distort(corner).norm() / 0.5 - 1.0, lens.CornerShift(), 1e-12);
}

TEST(RadialLens, WhatIsMissingStaysMissing) {
  const double missing = std::numeric_limits<double>::quiet_NaN();
  for (const RadialLens& lens : Lenses()) {
    EXPECT_TRUE(std::isnan(lens.Undistort({missing, missing}).x()));
    EXPECT_TRUE(std::isnan(lens.Distort({missing, missing}).x()));
  }
}

}  // namespace
}  // namespace canonpose
