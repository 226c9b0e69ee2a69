#include "canonpose/video/time_stamps.h"

#include <limits>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace canonpose {
namespace {

using ::testing::DoubleNear;
using ::testing::Pointwise;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

std::vector<double> TimesOf(TimeStamps& stamps, const std::vector<double>& seconds) {
  std::vector<double> times;
  for (std::size_t i = 0; i < seconds.size(); ++i) {
    times.push_back(stamps.Next(seconds[i], i + 1 < seconds.size() ? seconds[i + 1] : kNone));
  }
  return times;
}

std::vector<double> TimesOf(TimeStamps&& stamps, const std::vector<double>& seconds) {
  return TimesOf(stamps, seconds);
}

auto Near(const std::vector<double>& times) { return Pointwise(DoubleNear(1e-6), times); }

TEST(TimeStamps, CountsFromTheFirstFrame) {
  EXPECT_THAT(TimesOf(TimeStamps(10.0), {3.0, 3.1, 3.35}), Near({0.0, 0.1, 0.35}));
}

TEST(TimeStamps, GoesOnAtTheRateWhereStampsAreMissingAtTheEnd) {
  // As in some H.264 files: 0 for the last frames.
  TimeStamps stamps(10.0);
  EXPECT_THAT(TimesOf(stamps, {0.0, 0.1, 0.2, 0.0, 0.0}), Near({0.0, 0.1, 0.2, 0.3, 0.4}));
  EXPECT_EQ(stamps.corrected(), 0) << "which is usual";
  TimeStamps most_missing(10.0);
  for (int i = 0; i < 30; ++i) most_missing.Next(i < 10 ? 0.1 * i : 0.0, i < 9 ? 0.1 * (i + 1) : 0.0);
  EXPECT_EQ(most_missing.corrected(), 20);
}

TEST(TimeStamps, DoesNotBelieveStampsThatStandStillGoBackOrJumpFar) {
  EXPECT_THAT(TimesOf(TimeStamps(10.0), {0.0, 0.1, 0.1, 0.05, kNone, 1e9, 0.6}),
              Near({0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6}));
}

TEST(TimeStamps, KeepsTheTimesAfterOneDamagedStamp) {
  for (const double damaged : {30.0, 59.0, 1e6, -4.0, 0.45, 0.2, 0.0, kNone}) {
    TimeStamps stamps(10.0);
    EXPECT_THAT(TimesOf(stamps, {0.0, 0.1, 0.2, damaged, 0.4, 0.5, 0.6}), Near({0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6}))
        << damaged;
    EXPECT_EQ(stamps.corrected(), 1) << damaged;
  }
  // The last stamp cannot be confirmed.
  EXPECT_THAT(TimesOf(TimeStamps(10.0), {0.0, 0.1, 30.0}), Near({0.0, 0.1, 0.2}));
  // Less than an interval is left for the damaged one.
  EXPECT_THAT(TimesOf(TimeStamps(10.0), {0.0, 0.1, 30.0, 0.16, 0.26}), Near({0.0, 0.1, 0.13, 0.16, 0.26}));
}

TEST(TimeStamps, BelievesPauses) {
  TimeStamps stamps(10.0);
  EXPECT_THAT(TimesOf(stamps, {0.0, 0.1, 70.0, 70.1, 75.0, 100.0, 100.1}),
              Near({0.0, 0.1, 70.0, 70.1, 75.0, 100.0, 100.1}));
  EXPECT_EQ(stamps.corrected(), 0);
}

TEST(TimeStamps, GoesOnWithStampsThatBeginAnew) {
  // As of two recordings in one file: after five stamps that grow, their steps count again.
  TimeStamps stamps(10.0);
  EXPECT_THAT(TimesOf(stamps, {50.0, 50.1, 3.0, 3.1, 3.2, 3.3, 3.4, 3.5, 3.7, 3.8, 4.1}),
              Near({0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.9, 1.0, 1.3}));
  EXPECT_EQ(stamps.corrected(), 5);
  // The same where the first stamp is damaged, or the pause is too long to be one.
  EXPECT_THAT(TimesOf(TimeStamps(10.0), {50.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.8}),
              Near({0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.8}));
  EXPECT_THAT(TimesOf(TimeStamps(10.0), {0.0, 1e5, 1e5 + 0.1, 1e5 + 0.2, 1e5 + 0.3, 1e5 + 0.4, 1e5 + 0.5, 1e5 + 0.7}),
              Near({0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.8}));
}

TEST(TimeStamps, BeginsWithTheFirstStampThatThereIs) {
  TimeStamps stamps(10.0);
  EXPECT_THAT(TimesOf(stamps, {kNone, kNone, 5.0, 5.1, 5.3}), Near({0.0, 0.1, 0.2, 0.3, 0.5}));
  EXPECT_EQ(stamps.corrected(), 2);
}

TEST(TimeStamps, BelievesStampsThatAreSlowerThanTheContainerSays) {
  // Some containers state a rate of 1000.
  TimeStamps stamps(1000.0);
  EXPECT_THAT(TimesOf(stamps, {0.0, 0.033, 0.067, 0.1, 0.133}), Near({0.0, 0.033, 0.067, 0.1, 0.133}));
  EXPECT_EQ(stamps.corrected(), 0);
}

TEST(TimeStamps, AlwaysGrowsWhereTheRateIsUnknown) {
  for (const double fps : {0.0, -1.0, 1e9, kNone}) {
    TimeStamps stamps(fps);
    double last = stamps.Next(0.0, 0.0);
    EXPECT_EQ(last, 0.0);
    for (int i = 0; i < 3; ++i) {
      const double next = stamps.Next(0.0, 0.0);
      EXPECT_GT(next, last + 0.01);
      last = next;
    }
  }
}

}  // namespace
}  // namespace canonpose
