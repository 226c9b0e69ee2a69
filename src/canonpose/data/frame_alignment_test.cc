#include "canonpose/data/frame_alignment.h"

#include <cmath>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/base/random.h"
#include "canonpose/base/testing.h"

namespace canonpose {
namespace {

using ::testing::AllOf;
using testing::CollectedMessages;
using ::testing::ElementsAre;
using testing::ErrorOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using Numbers = std::vector<std::int64_t>;

/// A clip of one keypoint, whose x says in which frame it was.
KeypointClip Clip(const std::string& name, const Numbers& numbers, const std::vector<int>& moments,
                  double seconds_per_number = 0.0) {
  KeypointClip clip;
  clip.name = clip.path = name;
  clip.keypoint_count = 1;
  clip.frame_numbers = numbers;
  clip.seconds_per_number = seconds_per_number;
  for (const int moment : moments) {
    clip.keypoints.push_back(static_cast<float>(moment));
    clip.keypoints.push_back(0.0F);
    clip.confidence.push_back(1.0F);
  }
  return clip;
}

/// Numbers that are the moments.
KeypointClip Counted(const std::string& name, const std::vector<int>& moments, int add = 0) {
  Numbers numbers;
  for (const int moment : moments) numbers.push_back(moment + add);
  return Clip(name, numbers, moments);
}

std::vector<int> Range(int first, int last) {
  std::vector<int> range;
  for (int i = first; i <= last; ++i) range.push_back(i);
  return range;
}

std::vector<int> Without(std::vector<int> moments, int first, int last) {
  std::erase_if(moments, [&](int moment) { return moment >= first && moment <= last; });
  return moments;
}

/// The moments of a clip's frames; -1 where missing.
std::vector<int> Moments(const KeypointClip& clip) {
  std::vector<int> moments;
  for (std::size_t t = 0; t < clip.frame_numbers.size(); ++t) {
    EXPECT_EQ(std::isnan(clip.keypoints[2 * t]), clip.confidence[t] == 0.0F);
    moments.push_back(clip.confidence[t] == 0.0F ? -1 : static_cast<int>(clip.keypoints[2 * t]));
  }
  return moments;
}

/// Every frame shows one moment, and all clips have the same number of frames.
void ExpectMatched(const std::vector<KeypointClip>& clips) {
  const std::vector<int> first = Moments(clips.front());
  for (const KeypointClip& clip : clips) {
    const std::vector<int> moments = Moments(clip);
    ASSERT_EQ(moments.size(), first.size());
    for (std::size_t t = 0; t < moments.size(); ++t) {
      if (moments[t] >= 0 && first[t] >= 0) {
        EXPECT_EQ(moments[t], first[t]) << clip.name << " " << t;
      }
    }
  }
}

TEST(AlignFrames, EqualNumbersNeedNoWord) {
  std::vector<KeypointClip> clips{Counted("a", Range(0, 9)), Counted("b", Range(0, 9))};
  const CollectedMessages messages;
  EXPECT_EQ(AlignFrames(clips, FrameAlignment::kAutomatic), 0.0);
  EXPECT_THAT(messages.text(), IsEmpty());
  EXPECT_EQ(Moments(clips[0]), Range(0, 9));
}

TEST(AlignFrames, LostFilesAreMissingWithoutBeingAsked) {
  // As many in each, elsewhere; not as many; at the beginning and at the end; the same ones everywhere.
  for (const auto& [lost_a, lost_b] :
       {std::pair(std::pair(3, 6), std::pair(10, 13)), std::pair(std::pair(3, 6), std::pair(10, 11)),
        std::pair(std::pair(0, 3), std::pair(16, 19)), std::pair(std::pair(7, 9), std::pair(7, 9))}) {
    std::vector<KeypointClip> clips{Counted("a", Without(Range(0, 19), lost_a.first, lost_a.second)),
                                    Counted("b", Without(Range(0, 19), lost_b.first, lost_b.second))};
    const CollectedMessages messages;
    AlignFrames(clips, FrameAlignment::kAutomatic);
    ExpectMatched(clips);
    EXPECT_EQ(clips[0].frame_count(), 20);
    EXPECT_THAT(messages.text(), AllOf(HasSubstr("matched by the numbers in their names, 0 to 19; missing of 20: a"),
                                       HasSubstr(", b ")));
  }
}

TEST(AlignFrames, NumbersThatHaveNothingInCommonAreMatchedInOrder) {
  std::vector<KeypointClip> clips{Counted("a", Range(0, 9)), Counted("b", Range(0, 9), 1000)};
  const CollectedMessages messages;
  AlignFrames(clips, FrameAlignment::kAutomatic);
  ExpectMatched(clips);
  EXPECT_THAT(messages.text(), AllOf(HasSubstr("warning: "), HasSubstr("matched in order"),
                                     HasSubstr("a has 10 frames (0 to 9), b has 10 frames (1000 to 1009)")));
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { AlignFrames(clips, FrameAlignment::kFrameNumber); }),
              HasSubstr("expected frame numbers that another camera also has"));
  clips[1] = Counted("b", Range(0, 8), 1000);
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { AlignFrames(clips, FrameAlignment::kAutomatic); }),
              AllOf(HasSubstr("as many frames from every camera"), HasSubstr("b has 9 frames")));
}

TEST(AlignFrames, ACameraThatCountsEverySecondFrameIsMatchedInOrder) {
  Numbers every_second;
  for (int i = 0; i < 20; ++i) every_second.push_back(2 * i);
  std::vector<KeypointClip> clips{Counted("a", Range(0, 19)), Clip("b", every_second, Range(0, 19))};
  AlignFrames(clips, FrameAlignment::kAutomatic);
  ExpectMatched(clips);
  EXPECT_EQ(clips[0].frame_count(), 20);
}

TEST(AlignFrames, OneFrameOffMayBeAnotherBeginningOfTheCount) {
  std::vector<KeypointClip> clips{Counted("a", Range(0, 9)), Counted("b", Range(1, 10))};
  const CollectedMessages messages;
  AlignFrames(clips, FrameAlignment::kAutomatic);
  EXPECT_EQ(clips[0].frame_count(), 11);
  EXPECT_THAT(messages.text(), AllOf(HasSubstr("warning: "), HasSubstr("`align` order")));
}

TEST(AlignFrames, InOrderWhereAsked) {
  std::vector<KeypointClip> clips{Counted("a", Range(0, 9)), Counted("b", Range(1, 10))};
  AlignFrames(clips, FrameAlignment::kOrder);
  EXPECT_EQ(clips[0].frame_count(), 10);
  clips[1] = Counted("b", Range(1, 9));
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { AlignFrames(clips, FrameAlignment::kOrder); }),
              HasSubstr("`align` frame-number"));
}

/// Times in microseconds at 25 frames per second, with jitter and an offset.
KeypointClip Clocked(const std::string& name, const std::vector<int>& moments, double offset_s, double jitter_s,
                     std::uint64_t seed) {
  Rng rng(seed);
  Numbers numbers;
  for (const int moment : moments) {
    const double seconds = 0.04 * moment + offset_s + jitter_s * rng.Uniform();
    numbers.push_back(1'714'564'803'200'000 + std::llround(1e6 * seconds));
  }
  return Clip(name, numbers, moments, 1e-6);
}

TEST(AlignFrames, TimesAreMatchedWithTheNearest) {
  for (const double offset : {0.0, 0.012, 0.017, -0.017}) {
    std::vector<KeypointClip> clips{Clocked("a", Without(Range(0, 99), 30, 37), 0.0, 0.004, 1),
                                    Clocked("b", Without(Range(2, 99), 60, 61), offset, 0.004, 2),
                                    Clocked("c", Range(0, 95), 0.0, 0.0, 3)};
    const CollectedMessages messages;
    EXPECT_NEAR(AlignFrames(clips, FrameAlignment::kAutomatic), 25.0, 0.05) << offset;
    ExpectMatched(clips);
    EXPECT_EQ(clips[0].frame_count(), 100) << offset;
    EXPECT_EQ(clips[0].frame_numbers.front(), 0);
    EXPECT_THAT(messages.text(), AllOf(HasSubstr("matched by the times in their names, 2"),
                                       HasSubstr("missing of 100: a 8, b 4, c 4"), Not(HasSubstr("warning"))));
  }
}

TEST(AlignFrames, ClocksThatDifferByHoursBeginTogether) {
  std::vector<KeypointClip> clips{Clocked("a", Range(0, 49), 0.0, 0.002, 1),
                                  Clocked("b", Without(Range(0, 49), 20, 25), 7200.0, 0.002, 2)};
  const CollectedMessages messages;
  AlignFrames(clips, FrameAlignment::kAutomatic);
  ExpectMatched(clips);
  EXPECT_THAT(messages.text(), AllOf(HasSubstr("warning: "), HasSubstr("nothing in common"), HasSubstr("b's")));
}

TEST(AlignFrames, HalfTheRateFillsEverySecondFrame) {
  std::vector<int> every_second;
  for (int i = 0; i < 50; ++i) every_second.push_back(2 * i);
  std::vector<KeypointClip> clips{Clocked("a", every_second, 0.0, 0.002, 1), Clocked("b", Range(0, 99), 0.0, 0.002, 2)};
  EXPECT_NEAR(AlignFrames(clips, FrameAlignment::kAutomatic), 25.0, 0.05);
  ExpectMatched(clips);
  EXPECT_EQ(clips[0].frame_count(), 100);
}

TEST(AlignFrames, IrregularNumbersAreTimesOfUnknownUnit) {
  std::vector<KeypointClip> clips{Clip("a", {0, 33, 67, 100, 133, 167}, Range(0, 5)),
                                  Clip("b", {1, 34, 68, 134, 169}, {0, 1, 2, 4, 5})};
  const CollectedMessages messages;
  EXPECT_EQ(AlignFrames(clips, FrameAlignment::kAutomatic), 0.0);
  ExpectMatched(clips);
  EXPECT_EQ(clips[0].frame_count(), 6);
  EXPECT_THAT(messages.text(), HasSubstr("by the times in their names; missing of 6: b 1"));
}

TEST(AlignFrames, TimesAndCountersDoNotMatch) {
  std::vector<KeypointClip> clips{Clocked("a", Range(0, 9), 0.0, 0.0, 1), Counted("b", Range(0, 9))};
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { AlignFrames(clips, FrameAlignment::kAutomatic); }),
              AllOf(HasSubstr("b: expected frames named by the time, as those of a"), HasSubstr("`align` order")));
  AlignFrames(clips, FrameAlignment::kOrder);
}

TEST(CountFrames, CountsIntervals) {
  KeypointClip clip = Clocked("a", {0, 1, 2, 5, 6}, 0.0, 0.001, 1);
  EXPECT_NEAR(CountFrames(clip), 25.0, 0.3);
  EXPECT_THAT(clip.frame_numbers, ElementsAre(0, 1, 2, 5, 6));
  KeypointClip counted = Counted("a", {3, 4, 5});
  EXPECT_EQ(CountFrames(counted), 0.0);
  EXPECT_THAT(counted.frame_numbers, ElementsAre(3, 4, 5));
}

}  // namespace
}  // namespace canonpose
