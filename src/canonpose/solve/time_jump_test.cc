#include "canonpose/solve/time_jump.h"

#include <optional>

#include <gtest/gtest.h>

#include "canonpose/solve/exact_rig_testing.h"

namespace canonpose {
namespace {

constexpr int kView = 1;
constexpr int kFrames = 200;

/// A rig with errors of the usual size, whose view kView shows in frame n what it recorded in frame source(n).
template <typename Source>
std::optional<BadStretch> FindIn(Source&& source, int views = 4, int frames = kFrames) {
  testing::ExactRigOptions options;
  options.views = views;
  options.frames = frames;
  testing::ExactRig rig = testing::MakeExactRig(options);
  testing::SeeJoints(rig.truth, 0.004, 5, rig.capture);
  const CaptureObservations recorded = rig.capture;
  testing::TakeFrames(recorded, kView, source, rig.capture);
  Solution solution;
  solution.estimate = rig.truth;
  const std::optional<TimeJump> found = FindTimeJump(rig.capture, solution, 0, kView);
  return found ? std::optional(found->stretch) : std::nullopt;
}

TEST(FindTimeJump, FindsFramesThatWereLost) {
  for (const int lost : {4, 11, 20}) {
    const auto found = FindIn([&](int n) { return n < 120 ? n : n + lost; });
    ASSERT_TRUE(found) << lost;
    EXPECT_EQ(found->fault, StretchFault::kTimeJump);
    EXPECT_EQ(found->jump_frames, lost);
    EXPECT_NEAR(found->first, 120, 4) << lost;
    EXPECT_EQ(found->first + found->count, kFrames);
  }
}

TEST(FindTimeJump, FindsThemAlsoWhereTheRestIsInStep) {
  const auto found = FindIn([](int n) { return n < 70 ? n - 6 : n; });
  ASSERT_TRUE(found);
  EXPECT_EQ(found->first, 0);
  EXPECT_NEAR(found->count, 70, 4);
  EXPECT_EQ(found->jump_frames, -6);
}

TEST(FindTimeJump, FindsNothingInAViewThatIsInStep) {
  EXPECT_FALSE(FindIn([](int n) { return n; }));
  EXPECT_FALSE(FindIn([](int n) { return n; }, 3));
}

TEST(FindTimeJump, NeedsThreeViewsAndTime) {
  const auto loses = [](int n) { return n < 40 ? n : n + 8; };
  EXPECT_FALSE(FindIn(loses, 2));
  EXPECT_FALSE(FindIn(loses, 4, 60));
}

}  // namespace
}  // namespace canonpose
