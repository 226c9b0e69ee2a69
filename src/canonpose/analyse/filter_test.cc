#include "canonpose/analyse/filter.h"

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "canonpose/base/atomic_file.h"
#include "canonpose/base/testing.h"

namespace canonpose {
namespace {

using testing::ErrorOf;
using ::testing::HasSubstr;
using testing::TestData;

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

/// One joint that moves along x; NaN is a gap.
PoseSequence Track(const std::vector<float>& x, double fps = 50.0) {
  std::vector<float> positions;
  for (const float value : x) positions.insert(positions.end(), {value, std::isnan(value) ? kNaN : 2.0F * value, 5.0F});
  PoseSequence person(Skeleton{"", {"root"}, {-1}, 0, {0}}, std::move(positions));
  person.fps = fps;
  return person;
}

std::vector<float> X(const PoseSequence& person) {
  std::vector<float> x;
  for (int t = 0; t < person.frame_count(); ++t) x.push_back(person.PoseAt(t)(0, 0));
  return x;
}

TEST(LowPass, IsSciPysFiltfilt) {
  const nlohmann::json cases = nlohmann::json::parse(ReadFile(TestData("filter/filtfilt.json")));
  ASSERT_GE(cases.size(), 8U);
  for (const nlohmann::json& golden : cases) {
    const auto expected = golden["filtered"].get<std::vector<double>>();
    const std::vector<double> filtered =
        LowPass(golden["values"].get<std::vector<double>>(), golden["cutoff_hz"], golden["fps"]);
    ASSERT_EQ(filtered.size(), expected.size());
    for (std::size_t i = 0; i < expected.size(); ++i) {
      EXPECT_NEAR(filtered[i], expected[i], 1e-8) << golden["fps"] << " fps, value " << i;
    }
  }
}

/// The amplitude of a sine of this frequency after the filter, in the middle of a long curve, and its largest delay.
double GainAt(double frequency_hz, double cutoff_hz, double fps) {
  std::vector<double> values;
  const auto sine = [&](int t) { return std::sin(2.0 * std::numbers::pi * frequency_hz * t / fps); };
  for (int t = 0; t < 2000; ++t) values.push_back(sine(t));
  const std::vector<double> filtered = LowPass(values, cutoff_hz, fps);
  double product = 0.0;
  double power = 0.0;
  for (int t = 500; t < 1500; ++t) {
    product += filtered[static_cast<std::size_t>(t)] * sine(t);
    power += sine(t) * sine(t);
  }
  const double gain = product / power;
  for (int t = 500; t < 1500; ++t) EXPECT_NEAR(filtered[static_cast<std::size_t>(t)], gain * sine(t), 1e-6) << t;
  return gain;
}

TEST(LowPass, HalvesThePowerAtTheCutoffWithoutDelay) {
  EXPECT_NEAR(GainAt(6.0, 6.0, 100.0), std::sqrt(0.5), 1e-6);
  EXPECT_NEAR(GainAt(12.0, 12.0, 50.0), std::sqrt(0.5), 1e-6);
  EXPECT_NEAR(GainAt(0.5, 6.0, 100.0), 1.0, 1e-4);
  EXPECT_LT(GainAt(24.0, 6.0, 100.0), 0.02);
}

TEST(LowPass, FiltersEachStretchByItself) {
  const std::vector<float> first = {1, 4, 2, 6, 3, 9, 2, 4, 6, 1, 2, 5};
  const std::vector<float> second = {100, 90, 95, 99, 91};
  std::vector<float> both = first;
  both.insert(both.end(), {kNaN, kNaN});
  both.insert(both.end(), second.begin(), second.end());
  PoseSequence person = Track(both);
  LowPass(person, 6.0);
  PoseSequence alone = Track(first);
  LowPass(alone, 6.0);
  PoseSequence other = Track(second);
  LowPass(other, 6.0);
  std::vector<float> expected = X(alone);
  EXPECT_NE(expected, first);
  for (std::size_t t = 0; t < first.size(); ++t) EXPECT_EQ(X(person)[t], expected[t]) << t;
  EXPECT_FALSE(person.IsKnown(12, 0) || person.IsKnown(13, 0));
  for (std::size_t t = 0; t < second.size(); ++t) EXPECT_EQ(X(person)[14 + t], X(other)[t]) << t;
  EXPECT_FLOAT_EQ(person.PoseAt(3)(0, 1), 2.0F * person.PoseAt(3)(0, 0));
  EXPECT_FLOAT_EQ(person.PoseAt(3)(0, 2), 5.0F);
}

TEST(LowPass, AStretchEndsWhereTimeLeaps) {
  const std::vector<float> x = {1, 4, 2, 6, 3, 9, 2, 4, 60, 61, 66, 62, 60, 65};
  PoseSequence person = Track(x, 0.0);
  for (int t = 0; t < 14; ++t) person.time_seconds.push_back(0.02 * t + (t >= 8 ? 3.0 : 0.0));
  EXPECT_NEAR(FrameRateOf(person), 50.0, 1e-9);
  LowPass(person, 6.0);
  PoseSequence before = Track({x.begin(), x.begin() + 8});
  LowPass(before, 6.0);
  for (std::size_t t = 0; t < 8; ++t) EXPECT_NEAR(X(person)[t], X(before)[t], 1e-4) << t;
}

TEST(LowPass, WhatItCannotDoIsSaid) {
  PoseSequence person = Track({1, 2, 3});
  EXPECT_THAT(ErrorOf(ErrorKind::kInvalidArgument, [&] { LowPass(person, 25.0); }),
              HasSubstr("less than half the frame rate of 50, found 25"));
  person.fps = 0.0;
  EXPECT_THAT(ErrorOf(ErrorKind::kInvalidArgument, [&] { LowPass(person, 6.0); }), HasSubstr("need the frame rate"));
  EXPECT_THAT(ErrorOf(ErrorKind::kInvalidArgument, [&] { FillGaps(person, 0.1); }), HasSubstr("need the frame rate"));
  EXPECT_THAT(ErrorOf(ErrorKind::kInvalidArgument, [&] { Filter(person, {-1.0, 0.0}); }), HasSubstr("`cutoff_hz`"));
  EXPECT_THAT(ErrorOf(ErrorKind::kInvalidArgument,
                      [&] {
                        Filter(person, {0.0, std::nan("")});
                      }),
              HasSubstr("`longest_gap_seconds`"));
}

float Cubic(int t) {
  const float s = 0.1F * static_cast<float>(t);
  return 3.0F + 2.0F * s - 4.0F * s * s + s * s * s;
}

TEST(FillGaps, FollowsACubicAndKeepsConfidenceZero) {
  std::vector<float> x;
  for (int t = 0; t < 40; ++t) x.push_back(t >= 10 && t < 16 ? kNaN : Cubic(t));
  PoseSequence person = Track(x);
  FillGaps(person, 0.2);
  for (int t = 0; t < 40; ++t) {
    EXPECT_NEAR(X(person)[static_cast<std::size_t>(t)], Cubic(t), 1e-4) << t;
    EXPECT_NEAR(person.PoseAt(t)(0, 1), 2.0F * Cubic(t), 2e-4) << t;
    EXPECT_EQ(person.confidence()[static_cast<std::size_t>(t)], t >= 10 && t < 16 ? 0.0F : 1.0F) << t;
  }
}

TEST(FillGaps, LeavesLongGapsAndEnds) {
  // Gaps of 2 frames at the start, 5 and 6 frames, 1 frame at the end.
  std::vector<float> x(40, 1.0F);
  for (const int t : {0, 1, 8, 9, 10, 11, 12, 20, 21, 22, 23, 24, 25, 39}) x[static_cast<std::size_t>(t)] = kNaN;
  PoseSequence person = Track(x);
  FillGaps(person, 0.1);  // 5 frames
  for (int t = 0; t < 40; ++t) {
    const bool stays = t < 2 || t == 39 || (t >= 20 && t <= 25);
    EXPECT_EQ(person.IsKnown(t, 0), !stays) << t;
  }
}

TEST(FillGaps, MeetsBothEndsOfANoisyTrackWithoutSwinging) {
  std::vector<float> x;
  for (int t = 0; t < 40; ++t) {
    const float noise = t % 3 == 0 ? 4.0F : -2.0F;
    x.push_back(t >= 15 && t < 25 ? kNaN : static_cast<float>(t) + noise);
  }
  PoseSequence person = Track(x);
  FillGaps(person, 0.2);
  for (int t = 15; t < 25; ++t) EXPECT_NEAR(X(person)[static_cast<std::size_t>(t)], t, 8.0) << t;
  // The curve begins at the last known value: no step larger than the noise itself.
  EXPECT_NEAR(X(person)[15], X(person)[14], 3.0);
  EXPECT_NEAR(X(person)[24], X(person)[25], 3.0);
}

TEST(FillGaps, SingleFramesOnEitherSideAreJoinedByALine) {
  PoseSequence person = Track({kNaN, 2, kNaN, kNaN, 8, kNaN});
  FillGaps(person, 0.2);
  EXPECT_NEAR(X(person)[2], 4.0, 1e-5);
  EXPECT_NEAR(X(person)[3], 6.0, 1e-5);
  EXPECT_FALSE(person.IsKnown(0, 0) || person.IsKnown(5, 0));
}

TEST(Filter, IsOffUnlessAskedForAndSaysWhatItDid) {
  PoseSequence person = Track({1, 5, kNaN, 4, 9});
  const std::vector<float> before = person.positions();
  Filter(person, {});
  for (std::size_t i = 0; i < before.size(); ++i) {
    EXPECT_TRUE(person.positions()[i] == before[i] || std::isnan(before[i])) << i;
  }
  EXPECT_EQ(Describe({}), "");
  EXPECT_EQ(Describe({6.0, 0.0}), "Butterworth, 4th order, zero phase, 6 Hz");
  EXPECT_EQ(Describe({0.0, 0.25}), "gaps up to 0.25 s filled");
  EXPECT_EQ(Describe({6.5, 0.2}), "Butterworth, 4th order, zero phase, 6.5 Hz; gaps up to 0.2 s filled");
}

TEST(Filter, FillsBeforeItFilters) {
  std::vector<float> x = {1, 4, 2, 6, 3, kNaN, 2, 4, 6, 1, 2, 5};
  PoseSequence person = Track(x);
  Filter(person, {6.0, 0.05});
  PoseSequence filled = Track(x);
  FillGaps(filled, 0.05);
  LowPass(filled, 6.0);
  EXPECT_EQ(X(person), X(filled));
}

}  // namespace
}  // namespace canonpose
