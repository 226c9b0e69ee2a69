#include "canonpose/geometry/angles.h"

#include <numbers>

#include <gtest/gtest.h>

namespace canonpose {
namespace {

TEST(Angles, DegreesAndRadians) {
  static_assert(RadFromDeg(180.0) == std::numbers::pi);
  static_assert(DegFromRad(std::numbers::pi) == 180.0);
  EXPECT_DOUBLE_EQ(RadFromDeg(-30.0), -std::numbers::pi / 6.0);
  EXPECT_DOUBLE_EQ(DegFromRad(RadFromDeg(12.5)), 12.5);
}

}  // namespace
}  // namespace canonpose
