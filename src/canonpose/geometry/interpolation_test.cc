#include "canonpose/geometry/interpolation.h"

#include <gtest/gtest.h>

namespace canonpose {
namespace {

/// Of the values that `function` has at -1, 0, 1 and 2.
template <typename Function>
double Interpolate(const std::array<double, 4>& weights, Function function) {
  double value = 0.0;
  for (int i = 0; i < 4; ++i) value += weights[static_cast<std::size_t>(i)] * function(i - 1.0);
  return value;
}

TEST(Interpolation, PassesThroughTheSamples) {
  const std::array<double, 4> at = {0.0, 1.0, 0.0, 0.0};
  const std::array<double, 4> after = {0.0, 0.0, 1.0, 0.0};
  EXPECT_EQ(CubicWeights(0.0), at);
  EXPECT_EQ(CubicWeights(1.0), after);
  EXPECT_EQ(LinearWeights(0.0), at);
  EXPECT_EQ(LinearWeights(1.0), after);
}

TEST(Interpolation, IsExactForLinesAndParabolas) {
  const auto line = [](double x) { return 3.0 - 2.0 * x; };
  const auto parabola = [](double x) { return 1.0 + x - 4.0 * x * x; };
  for (const double share : {0.1, 0.25, 0.5, 0.9}) {
    EXPECT_NEAR(Interpolate(LinearWeights(share), line), line(share), 1e-12);
    EXPECT_NEAR(Interpolate(CubicWeights(share), line), line(share), 1e-12);
    EXPECT_NEAR(Interpolate(CubicWeights(share), parabola), parabola(share), 1e-12);
  }
}

}  // namespace
}  // namespace canonpose
