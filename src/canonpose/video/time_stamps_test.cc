#include "canonpose/video/time_stamps.h"

#include <limits>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace canonpose {
namespace {

using ::testing::DoubleNear;
using ::testing::Pointwise;

std::vector<double> TimesOf(TimeStamps stamps, const std::vector<double>& seconds) {
  std::vector<double> times;
  for (const double stamp : seconds) times.push_back(stamps.Next(stamp));
  return times;
}

TEST(TimeStamps, CountsFromTheFirstFrame) {
  EXPECT_THAT(TimesOf(TimeStamps(10.0), {3.0, 3.1, 3.35}), Pointwise(DoubleNear(1e-9), {0.0, 0.1, 0.35}));
}

TEST(TimeStamps, GoesOnAtTheRateWhereStampsAreMissingAtTheEnd) {
  // As in some H.264 files: 0 for the last frames.
  TimeStamps stamps(10.0);
  for (const double stamp : {0.0, 0.1, 0.2}) stamps.Next(stamp);
  EXPECT_NEAR(stamps.Next(0.0), 0.3, 1e-9);
  EXPECT_NEAR(stamps.Next(0.0), 0.4, 1e-9);
  EXPECT_EQ(stamps.corrected(), 2);
}

TEST(TimeStamps, DoesNotBelieveStampsThatStandStillGoBackOrJumpFar) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(TimesOf(TimeStamps(10.0), {0.0, 0.1, 0.1, 0.05, nan, 1e9, 0.6}),
              Pointwise(DoubleNear(1e-9), {0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6}));
}

TEST(TimeStamps, AlwaysGrowsWhereTheRateIsUnknown) {
  for (const double fps : {0.0, -1.0, 1e9, std::numeric_limits<double>::quiet_NaN()}) {
    TimeStamps stamps(fps);
    double last = stamps.Next(0.0);
    EXPECT_EQ(last, 0.0);
    for (int i = 0; i < 3; ++i) {
      const double next = stamps.Next(0.0);
      EXPECT_GT(next, last + 0.01);
      last = next;
    }
  }
}

}  // namespace
}  // namespace canonpose
