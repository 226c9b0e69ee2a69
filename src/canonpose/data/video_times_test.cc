#include "canonpose/data/video_times.h"

#include <numeric>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace canonpose {
namespace {

using ::testing::ElementsAre;

KeypointClip Clip(int frames) {
  KeypointClip clip;
  clip.frame_numbers.resize(static_cast<std::size_t>(frames));
  std::iota(clip.frame_numbers.begin(), clip.frame_numbers.end(), 0);
  return clip;
}

VideoFacts Facts(double fps, std::vector<double> times) {
  VideoFacts facts;
  facts.image_size = {64, 48};
  facts.fps = fps;
  facts.times_seconds = std::move(times);
  return facts;
}

TEST(VideoTimes, CountsIntervalsOfOneConstantRate) {
  std::vector<KeypointClip> clips{Clip(4), Clip(3)};
  // The first video's third frame was damaged; the second's stamps are rounded, and begin with another time.
  const double fps =
      NumberByVideoTimes(clips, {Facts(25.0, {0.0, 0.04, 0.12, 0.16}), Facts(25.0, {0.002, 0.041, 0.083})});
  EXPECT_DOUBLE_EQ(fps, 25.0);
  EXPECT_THAT(clips[0].frame_numbers, ElementsAre(0, 1, 3, 4));
  EXPECT_THAT(clips[1].frame_numbers, ElementsAre(0, 1, 2));
  EXPECT_EQ(clips[0].seconds_per_number, 0.0);
}

TEST(VideoTimes, TakesTimesWhereRatesDifferOrVary) {
  for (const auto& second : {Facts(50.0, {0.0, 0.02, 0.04}), Facts(25.0, {0.0, 0.04, 0.1})}) {
    std::vector<KeypointClip> clips{Clip(3), Clip(3)};
    EXPECT_EQ(NumberByVideoTimes(clips, {Facts(25.0, {0.0, 0.04, 0.08}), second}), 0.0);
    EXPECT_THAT(clips[0].frame_numbers, ElementsAre(0, 40000, 80000));
    EXPECT_DOUBLE_EQ(clips[1].seconds_per_number, 1e-6);
  }
}

TEST(VideoTimes, LeavesClipsAloneUnlessAllHaveTimes) {
  const VideoFacts facts = Facts(25.0, {0.0, 0.04, 0.12});
  for (const std::optional<VideoFacts>& second :
       {std::optional<VideoFacts>(), std::optional(Facts(0.0, {})), std::optional(Facts(25.0, {0.0, 0.04}))}) {
    std::vector<KeypointClip> clips{Clip(3), Clip(3)};
    EXPECT_EQ(NumberByVideoTimes(clips, {facts, second}), 0.0);
    EXPECT_THAT(clips[0].frame_numbers, ElementsAre(0, 1, 2));
    EXPECT_THAT(clips[1].frame_numbers, ElementsAre(0, 1, 2));
  }
}

}  // namespace
}  // namespace canonpose
