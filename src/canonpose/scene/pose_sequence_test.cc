#include "canonpose/scene/pose_sequence.h"

#include <cmath>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

namespace canonpose {
namespace {

Skeleton Stick() { return {"", {"root", "tip"}, {-1, 0}, 0, {0, 1}}; }

TEST(PoseSequence, BeginsWithAllJointsMissing) {
  const PoseSequence poses(Stick(), 3);
  EXPECT_EQ(poses.frame_count(), 3);
  EXPECT_EQ(poses.positions().size(), 18U);
  EXPECT_EQ(poses.confidence(), std::vector<float>(6, 0.0F));
  EXPECT_FALSE(poses.IsKnown(2, 1));
  EXPECT_TRUE(std::isnan(poses.standard_deviation()[0]));
}

TEST(PoseSequence, TakesPositionsRowByRow) {
  const float nan = std::nanf("");
  const PoseSequence poses(Stick(), {0, 0, 0, 1, 2, 3, 4, 5, 6, nan, nan, nan});
  EXPECT_EQ(poses.frame_count(), 2);
  EXPECT_EQ(poses.PoseAt(0)(1, 2), 3.0F);
  EXPECT_EQ(poses.PoseAt(1)(0, 1), 5.0F);
  EXPECT_EQ(poses.confidence(), (std::vector<float>{1, 1, 1, 0}));
  EXPECT_TRUE(poses.IsKnown(1, 0));
  EXPECT_FALSE(poses.IsKnown(1, 1));
}

TEST(PoseSequence, WritesThroughItsPoses) {
  PoseSequence poses(Stick(), 2);
  poses.PoseAt(1).row(1) << 7, 8, 9;
  EXPECT_EQ(poses.positions()[9], 7.0F);
  EXPECT_EQ(poses.positions()[11], 9.0F);
}

TEST(PoseSequence, RefusesHalfAPose) {
  EXPECT_THROW(PoseSequence(Stick(), std::vector<float>(7)), std::logic_error);
  EXPECT_THROW(PoseSequence(Skeleton(), std::vector<float>(3)), std::logic_error);
}

TEST(PoseSequence, KnowsTheTimeFromStampsOrTheFrameRate) {
  PoseSequence poses(Stick(), 3);
  EXPECT_EQ(poses.TimeOf(2), 2.0);
  poses.fps = 50.0;
  EXPECT_DOUBLE_EQ(poses.TimeOf(2), 0.04);
  poses.time_seconds = {0.0, 0.1, 0.5};
  EXPECT_EQ(poses.TimeOf(2), 0.5);
}

}  // namespace
}  // namespace canonpose
