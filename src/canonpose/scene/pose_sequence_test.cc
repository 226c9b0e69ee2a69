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

TEST(PoseSequence, TrustsOnlyJointsWithAllCoordinates) {
  PoseSequence poses(Stick(), {0, 0, std::nanf(""), 1, 2, 3});
  EXPECT_EQ(poses.confidence(), (std::vector<float>{0, 1}));
  EXPECT_TRUE(poses.AnyKnown());
  poses.positions()[4] = std::nanf("");
  poses.TrustKnownJoints();
  EXPECT_EQ(poses.confidence(), (std::vector<float>{0, 0}));
  EXPECT_FALSE(poses.AnyKnown());
  EXPECT_FALSE(PoseSequence().AnyKnown());
}

TEST(PoseSequence, KeepsFramesOfEveryArray) {
  PoseSequence poses(Stick(), 7);
  poses.fps = 50.0;
  for (int t = 0; t < 7; ++t) {
    poses.PoseAt(t).setConstant(static_cast<float>(t));
    poses.standard_deviation()[static_cast<std::size_t>(2 * t + 1)] = static_cast<float>(t);
    poses.time_seconds.push_back(0.1 * t);
  }
  poses.TrustKnownJoints();
  poses.KeepFrames(1, 5, 2);
  ASSERT_EQ(poses.frame_count(), 3);
  EXPECT_EQ(poses.positions().size(), 18U);
  EXPECT_EQ(poses.PoseAt(2)(1, 2), 5.0F);
  EXPECT_EQ(poses.confidence(), std::vector<float>(6, 1.0F));
  EXPECT_EQ(poses.standard_deviation()[3], 3.0F);
  EXPECT_EQ(poses.time_seconds, (std::vector<double>{0.1, 0.1 * 3, 0.1 * 5}));
  EXPECT_EQ(poses.fps, 25.0);
  poses.KeepFrames(1, 100);
  EXPECT_EQ(poses.frame_count(), 2);
  poses.KeepFrames(2, 100);
  EXPECT_TRUE(poses.empty());
  EXPECT_TRUE(poses.positions().empty());
}

TEST(PoseSequence, SaysWhatItsCoordinatesMean) {
  const std::vector<float> positions = {0, 0, 0, 1, 2, 3};
  const PoseSequence truth = PosesInCamera(Stick(), positions, LengthUnit::kMillimetres, "cam1");
  EXPECT_EQ(truth.positions(), positions);
  EXPECT_EQ(truth.unit, LengthUnit::kMillimetres);
  EXPECT_EQ(truth.coordinate_frame, (CoordinateFrame{CoordinateFrame::Kind::kCamera, "cam1"}));
  const PoseSequence lifted = PosesAboutRoot(Stick(), positions, "cam1");
  EXPECT_EQ(lifted.unit, LengthUnit::kEachItsOwn);
  EXPECT_EQ(lifted.coordinate_frame, (CoordinateFrame{CoordinateFrame::Kind::kRoot, "cam1"}));
  EXPECT_TRUE(PosesInCamera(Stick(), {}, LengthUnit::kMillimetres, "cam1").empty());
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
