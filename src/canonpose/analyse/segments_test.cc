#include "canonpose/analyse/segments.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "canonpose/analyse/figure_testing.h"

namespace canonpose {
namespace {

using testing::Moving;

TEST(FindBodyJoints, KnowsTheSkeletonsByTheirNames) {
  const BodyJoints h36m = FindBodyJoints(*FindSkeleton("h36m-17"));
  EXPECT_EQ(h36m.right.ankle, FindSkeleton("h36m-17")->Find("RFoot"));
  EXPECT_EQ(h36m.left.wrist, FindSkeleton("h36m-17")->Find("LWrist"));
  EXPECT_EQ(h36m.left.big_toe, -1);
  EXPECT_GE(h36m.spine, 0);
  EXPECT_TRUE(h36m.has_trunk());
  const BodyJoints body_25 = FindBodyJoints(*FindSkeleton("body_25"));
  EXPECT_EQ(body_25.left.small_toe, FindSkeleton("body_25")->Find("LSmallToe"));
  EXPECT_EQ(body_25.right.heel, FindSkeleton("body_25")->Find("RHeel"));
  EXPECT_EQ(body_25.spine, -1);
  for (const Skeleton& skeleton : BenchmarkSkeletons()) {
    if (skeleton.name == "3dhp-28") {
      EXPECT_EQ(FindBodyJoints(skeleton).left.big_toe, skeleton.Find("left_toe"));
    }
  }
}

TEST(Segments, AreRightHandedAndPointForwardUpAndRight) {
  // The figure faces along x; its left is y. A knee and an elbow bent by 90 degrees show all axes.
  const PoseSequence person =
      Moving({{{"knee_angle_r", 90}, {"knee_angle_l", 90}, {"elbow_flex_r", 90}, {"elbow_flex_l", 90}}});
  const Segments segments = SegmentsAt(person, FindBodyJoints(person), 0);
  Eigen::Matrix3d neutral;
  neutral << 1, 0, 0, 0, 0, -1, 0, 1, 0;
  EXPECT_LT((segments.pelvis - neutral).norm(), 1e-5) << segments.pelvis;
  EXPECT_LT((segments.trunk - neutral).norm(), 1e-5) << segments.trunk;
  for (const Side side : kSides) {
    EXPECT_LT((segments.Of(side).thigh - neutral).norm(), 1e-5) << segments.Of(side).thigh;
    EXPECT_LT((segments.Of(side).upper_arm - neutral).norm(), 1e-5) << segments.Of(side).upper_arm;
    // The shank lies behind the knee, so that its up is forward.
    EXPECT_LT((segments.Of(side).shank.col(1) - neutral.col(0)).norm(), 1e-5) << segments.Of(side).shank;
    EXPECT_NEAR(segments.Of(side).foot.determinant(), 1.0, 1e-5);
    EXPECT_GT(segments.Of(side).foot.col(0).dot(-neutral.col(1)), 0.99);
  }
}

TEST(Segments, WithoutAPlaneHaveALongAxisOnly) {
  const PoseSequence person = Moving({{{"knee_angle_r", 9}, {"knee_angle_l", 11}}});
  const Segments segments = SegmentsAt(person, FindBodyJoints(person), 0);
  EXPECT_TRUE(segments.right.thigh.col(1).allFinite());
  EXPECT_TRUE(segments.right.thigh.col(0).array().isNaN().all());
  EXPECT_TRUE(segments.right.shank.col(2).array().isNaN().all());
  EXPECT_TRUE(segments.left.thigh.allFinite());
}

TEST(AngleBetween, IsExactForSmallAndLargeAngles) {
  const Eigen::Vector3d x(1, 0, 0);
  EXPECT_NEAR(AngleBetween(x, {1, 1e-8, 0}), 1e-8, 1e-15);
  EXPECT_NEAR(AngleBetween(x, {-2, 0, 0}), std::numbers::pi, 1e-15);
  EXPECT_TRUE(std::isnan(AngleBetween(x, {std::nan(""), 0, 0})));
}

}  // namespace
}  // namespace canonpose
