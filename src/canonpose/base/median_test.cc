#include "canonpose/base/median.h"

#include <cmath>

#include <gtest/gtest.h>

namespace canonpose {
namespace {

TEST(Median, OfOddEvenAndNoValues) {
  EXPECT_EQ(Median({3.0, 1.0, 100.0}), 3.0);
  EXPECT_EQ(Median({4.0, 1.0, 2.0, 100.0}), 3.0);
  EXPECT_TRUE(std::isnan(Median({})));
}

}  // namespace
}  // namespace canonpose
