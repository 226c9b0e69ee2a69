#include "canonpose/solve/frame_choice.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace canonpose {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

TEST(ConsecutiveFrames, StartAtTheFirst) {
  EXPECT_THAT(ConsecutiveFrames(5, 3), ElementsAre(5, 6, 7));
  EXPECT_THAT(ConsecutiveFrames(5, 0), IsEmpty());
}

TEST(EvenlySpread, TakesEveryNthFrame) {
  EXPECT_THAT(EvenlySpread(ConsecutiveFrames(10, 9), 3), ElementsAre(10, 13, 16));
  EXPECT_THAT(EvenlySpread(ConsecutiveFrames(0, 5), 3), ElementsAre(0, 1, 3));
}

TEST(EvenlySpread, TakesAllOfFewFrames) {
  EXPECT_THAT(EvenlySpread(std::vector<int>{2, 3, 7}, 3), ElementsAre(2, 3, 7));
  EXPECT_THAT(EvenlySpread(std::vector<int>{2, 3, 7}, 100), ElementsAre(2, 3, 7));
  EXPECT_THAT(EvenlySpread({}, 3), IsEmpty());
}

TEST(EvenRuns, ReachFromTheFirstFrameToTheLast) {
  EXPECT_THAT(EvenRuns(ConsecutiveFrames(100, 10), 3, 2), ElementsAre(100, 101, 104, 105, 108, 109));
}

TEST(EvenRuns, AreAsManyAsThereIsRoomFor) {
  EXPECT_THAT(EvenRuns(ConsecutiveFrames(0, 7), 6, 3), ElementsAre(0, 1, 2, 4, 5, 6));
  EXPECT_THAT(EvenRuns(ConsecutiveFrames(0, 6), 6, 3), ElementsAre(0, 1, 2, 3, 4, 5));
  EXPECT_THAT(EvenRuns(ConsecutiveFrames(0, 5), 6, 3), ElementsAre(0, 1, 2));
  EXPECT_THAT(EvenRuns(ConsecutiveFrames(0, 2), 6, 3), ElementsAre(0, 1));
  EXPECT_THAT(EvenRuns({}, 6, 3), IsEmpty());
}

}  // namespace
}  // namespace canonpose
