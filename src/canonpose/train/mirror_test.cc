#include "canonpose/train/mirror.h"

#include <gtest/gtest.h>

#include "canonpose/base/random.h"

namespace canonpose {
namespace {

/// The slope of a synthetic person with perspective factor k, measured with the right depths or with reversed ones.
double SyntheticSlope(double k, bool mirrored) {
  Rng rng(5);
  SlopeRegression regression;
  for (int pose = 0; pose < 50; ++pose) {
    constexpr int kJoints = 17;
    double x[kJoints];
    double y[kJoints];
    double z[kJoints];
    for (int j = 0; j < kJoints; ++j) {
      x[j] = 0.14 * rng.Normal();
      y[j] = 0.14 * rng.Normal();
      z[j] = 0.14 * rng.Normal();
    }
    double seen_norm = 0.0;
    double norm = 0.0;
    for (int j = 0; j < kJoints; ++j) {
      const double divisor = 1.0 + k * z[j];
      seen_norm += (x[j] * x[j] + y[j] * y[j]) / (divisor * divisor);
      norm += x[j] * x[j] + y[j] * y[j];
    }
    for (int j = 0; j < kJoints; ++j) {
      for (const double coordinate : {x[j], y[j]}) {
        const double seen = coordinate / (1.0 + k * z[j]) / std::sqrt(seen_norm);
        const double projected = coordinate / std::sqrt(norm);
        regression.Add(seen - projected, projected, mirrored ? -z[j] : z[j], 1.0);
      }
    }
  }
  double slope = 0.0;
  EXPECT_TRUE(regression.Solve(slope));
  return slope;
}

TEST(SlopeRegression, FindsMinusThePerspectiveFactor) {
  EXPECT_NEAR(SyntheticSlope(0.3, false), -0.3, 0.04);  // to first order in k z
  EXPECT_NEAR(SyntheticSlope(0.3, true), 0.3, 0.04);
  EXPECT_NEAR(SyntheticSlope(0.0, false), 0.0, 1e-9);
}

TEST(SlopeRegression, SaysWhereDataDoNotDetermineIt) {
  double slope = 7.0;
  EXPECT_FALSE(SlopeRegression().Solve(slope));
  SlopeRegression flat;
  flat.Add(0.1, 0.5, 0.0, 1.0);
  flat.Add(0.2, 0.3, 0.0, 1.0);
  EXPECT_FALSE(flat.Solve(slope));
  EXPECT_EQ(slope, 7.0);
}

TEST(CombineSlopes, MeanAndStandardErrorByHand) {
  const PerspectiveSlope slope = CombineSlopes({-0.1, -0.2, -0.3, -0.2});
  EXPECT_NEAR(slope.slope, -0.2, 1e-12);
  EXPECT_NEAR(slope.standard_error, std::sqrt(0.02 / 3.0 / 4.0), 1e-12);
  EXPECT_TRUE(slope.is_sure());
  EXPECT_FALSE(slope.is_mirrored());
}

TEST(CombineSlopes, IsNotSureOfNoiseOrOfFewClips) {
  EXPECT_FALSE(CombineSlopes({-0.3, 0.2, -0.1, 0.25}).is_sure());
  EXPECT_FALSE(CombineSlopes({-0.30, -0.31, -0.30}).is_sure());
  EXPECT_FALSE(CombineSlopes({}).is_sure());
}

}  // namespace
}  // namespace canonpose
