#include "canonpose/data/clip_timing.h"

#include <cmath>
#include <numeric>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/base/testing.h"

namespace canonpose {
namespace {

using ::testing::HasSubstr;

/// A keypoint that moves as a parabola of the time, and one that is never seen.
double PlaceAt(double seconds) { return 100.0 + 50.0 * seconds - 20.0 * seconds * seconds; }

KeypointClip Clip(const std::string& name, const std::vector<double>& times, int first_number = 0) {
  KeypointClip clip;
  clip.name = name;
  clip.keypoint_count = 2;
  for (std::size_t i = 0; i < times.size(); ++i) {
    clip.frame_numbers.push_back(first_number + static_cast<std::int64_t>(i));
    const auto place = static_cast<float>(PlaceAt(times[i]));
    clip.keypoints.insert(clip.keypoints.end(), {place, 2.0F * place, std::nanf(""), std::nanf("")});
    clip.confidence.insert(clip.confidence.end(), {0.8F, 0.0F});
  }
  return clip;
}

std::vector<double> Regular(double fps, double seconds) {
  std::vector<double> times;
  for (int t = 0; t <= std::lround(fps * seconds); ++t) times.push_back(t / fps);
  return times;
}

std::optional<VideoFacts> Facts(const std::vector<double>& times) {
  VideoFacts facts;
  facts.image_size = {64, 48};
  facts.fps = 1.0 / (times[1] - times[0]);
  facts.times_seconds = times;
  return facts;
}

const std::vector<std::optional<VideoFacts>> kNoFacts(2);

TEST(ResampleToCommonRate, InterpolatesSmoothMotion) {
  const std::vector<std::vector<double>> times = {Regular(25.0, 2.0), Regular(60.0, 1.5)};
  std::vector<KeypointClip> clips = {Clip("slow", times[0]), Clip("fast", times[1])};
  EXPECT_NEAR(ResampleToCommonRate(times, clips), 60.0, 1e-9);
  for (const KeypointClip& clip : clips) {
    ASSERT_EQ(clip.frame_count(), 121);
    EXPECT_EQ(clip.frame_numbers.front(), 0);
    EXPECT_EQ(clip.frame_numbers.back(), 120);
    const double end = clip.name == "slow" ? 2.0 : 1.5;
    for (std::size_t n = 0; n < 121; ++n) {
      const double time = static_cast<double>(n) / 60.0;
      EXPECT_EQ(clip.confidence[2 * n + 1], 0.0F);
      EXPECT_TRUE(std::isnan(clip.keypoints[4 * n + 2]));
      if (time > end + 1e-9) {
        EXPECT_EQ(clip.confidence[2 * n], 0.0F) << clip.name << " " << n;
        EXPECT_TRUE(std::isnan(clip.keypoints[4 * n]));
        continue;
      }
      EXPECT_NEAR(clip.confidence[2 * n], 0.8, 1e-6);
      // At the ends only a line is known.
      EXPECT_NEAR(clip.keypoints[4 * n], PlaceAt(time), time < 0.04 || time > end - 0.04 ? 0.01 : 1e-4);
    }
  }
}

TEST(ResampleToCommonRate, DoesNotBridgeLostFrames) {
  std::vector<double> times = Regular(25.0, 1.0);
  times.erase(times.begin() + 10, times.begin() + 13);
  std::vector<KeypointClip> clips = {Clip("a", times), Clip("b", Regular(50.0, 1.0))};
  EXPECT_NEAR(ResampleToCommonRate({times, Regular(50.0, 1.0)}, clips), 50.0, 1e-9);
  for (std::size_t n = 0; n <= 50; ++n) {
    EXPECT_EQ(clips[0].confidence[2 * n] > 0.0F, n <= 18 || n >= 26) << n;
    EXPECT_GT(clips[1].confidence[2 * n], 0.0F);
  }
}

TEST(ResampleToCommonRate, NeedsNoMoreThanSixtyPerSecond) {
  const std::vector<std::vector<double>> times = {Regular(240.0, 0.5), Regular(30.0, 0.5)};
  std::vector<KeypointClip> clips = {Clip("a", times[0]), Clip("b", times[1])};
  EXPECT_NEAR(ResampleToCommonRate(times, clips), 30.0, 1e-9);
  const std::vector<std::vector<double>> fast = {Regular(240.0, 0.5), Regular(120.0, 0.5)};
  clips = {Clip("a", fast[0]), Clip("b", fast[1])};
  EXPECT_NEAR(ResampleToCommonRate(fast, clips), 120.0, 1e-9);
}

TEST(TimeClips, VideosOfOneRateAndLengthBelongTogether) {
  const std::vector<double> times = Regular(25.0, 2.0);
  std::vector<KeypointClip> clips = {Clip("a", times), Clip("b", times)};
  const std::vector<KeypointClip> before = clips;
  const ClipTiming timing = TimeClips(clips, {Facts(times), Facts(times)}, {}, FrameAlignment::kAutomatic);
  EXPECT_EQ(timing.timing, FrameTiming::kCommon);
  EXPECT_NEAR(timing.fps, 25.0, 1e-9);
  EXPECT_EQ(clips[1].confidence, before[1].confidence);
}

TEST(TimeClips, VideosOfOtherLengthsMayHaveBegunAtOtherTimes) {
  const std::vector<double> times = Regular(25.0, 2.0);
  const std::vector<double> shorter = Regular(25.0, 1.2);
  std::vector<KeypointClip> clips = {Clip("a", times), Clip("b", shorter)};
  const ClipTiming timing = TimeClips(clips, {Facts(times), Facts(shorter)}, {}, FrameAlignment::kAutomatic);
  EXPECT_EQ(timing.timing, FrameTiming::kUnsure);
  EXPECT_EQ(clips[1].frame_count(), 51);
  EXPECT_EQ(clips[1].confidence[2 * 31], 0.0F);
}

TEST(TimeClips, NobodySynchronisedThem) {
  std::vector<KeypointClip> clips = {Clip("a", Regular(25.0, 2.0), 100), Clip("b", Regular(25.0, 1.2), 7)};
  const ClipTiming timing = TimeClips(clips, kNoFacts, {}, FrameAlignment::kNone);
  EXPECT_EQ(timing.timing, FrameTiming::kOwn);
  EXPECT_EQ(timing.fps, 0.0);
  for (const KeypointClip& clip : clips) {
    ASSERT_EQ(clip.frame_count(), 51);
    EXPECT_FLOAT_EQ(clip.keypoints[0], static_cast<float>(PlaceAt(0.0)));
  }
  EXPECT_EQ(clips[1].confidence[2 * 31], 0.0F);
}

TEST(TimeClips, GivenRatesAreTheClocks) {
  std::vector<KeypointClip> clips = {Clip("a", Regular(25.0, 2.0)), Clip("b", Regular(50.0, 2.0))};
  const GivenRates rates{25.0, {{"b", 50.0}}};
  const ClipTiming timing = TimeClips(clips, kNoFacts, rates, FrameAlignment::kAutomatic);
  EXPECT_EQ(timing.timing, FrameTiming::kUnsure);
  EXPECT_NEAR(timing.fps, 50.0, 1e-9);
  EXPECT_NEAR(clips[0].keypoints[4 * 51], PlaceAt(1.02), 1e-3);
  clips = {Clip("a", Regular(25.0, 2.0)), Clip("b", Regular(50.0, 2.0))};
  EXPECT_THAT(testing::ErrorOf(ErrorKind::kInvalidArgument,
                               [&] {
                                 (void)TimeClips(clips, kNoFacts, {0.0, {{"b", 50.0}}}, FrameAlignment::kAutomatic);
                               }),
              HasSubstr("found none of a"));
}

TEST(TimeClips, OtherNumbersAndLengthsAreNoReasonToGiveUp) {
  std::vector<KeypointClip> clips = {Clip("a", Regular(25.0, 2.0)), Clip("b", Regular(25.0, 1.2), 5000)};
  const ClipTiming timing = TimeClips(clips, kNoFacts, {25.0, {}}, FrameAlignment::kAutomatic);
  EXPECT_EQ(timing.timing, FrameTiming::kOwn);
  EXPECT_NEAR(timing.fps, 25.0, 1e-9);
}

}  // namespace
}  // namespace canonpose
