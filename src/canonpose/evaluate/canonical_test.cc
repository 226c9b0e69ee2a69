#include "canonpose/evaluate/canonical.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/base/testing.h"

namespace canonpose {
namespace {

const Skeleton kSkeleton{"", {"Pelvis", "RHip", "LHip"}, {-1, 0, 0}, 0, {0, 2, 1}};

PoseErrors Scale(double scale) {
  PoseErrors errors;
  errors.outcome = PoseOutcome::kEvaluated;
  errors.scale = scale;
  return errors;
}

/// A pose with the right hip at x and the left hip at 10, in the lifter's unit; its root is not at the origin.
std::vector<float> Pose(float x) { return {1, 1, 1, 1 + x, 1, 1, 11, 1, 1}; }

TEST(CanonicalTest, DeviationsByHand) {
  CanonicalSpread spread(kSkeleton);
  // In millimetres, at a scale of 10: right hips at 40 and 60 in the first frame, 100 and 120 in the second.
  for (const auto& [first, second] : {std::pair(4.0F, 6.0F), std::pair(10.0F, 12.0F)}) {
    spread.AddView(Pose(first).data(), Scale(10.0));
    spread.AddView(Pose(second).data(), Scale(10.0));
    spread.EndFrame();
  }
  const CanonicalReport report = spread.Finish().value();
  EXPECT_EQ(report.poses, 4);
  const CanonicalDeviations& right = report.per_joint[1].second;
  EXPECT_NEAR(right.views_mm, 10.0, 1e-9);
  EXPECT_NEAR(right.frames_mm, 30.0, 1e-9) << "means of 50 and 110";
  EXPECT_NEAR(right.std_mm, std::sqrt(10.0 * 10.0 + 30.0 * 30.0), 1e-9);
  EXPECT_NEAR(*report.right_hip_std_mm, right.std_mm, 1e-12);
  EXPECT_NEAR(*report.left_hip_std_mm, 0.0, 1e-9);
  EXPECT_NEAR(report.all.views_mm, 10.0 / 3.0, 1e-9);
  EXPECT_NEAR(report.all.frames_mm, 10.0, 1e-9);
}

TEST(CanonicalTest, PosesWithoutScaleAndFramesOfOneView) {
  CanonicalSpread spread(kSkeleton);
  PoseErrors missing = Scale(1.0);
  missing.outcome = PoseOutcome::kPredictionMissing;
  spread.AddView(Pose(5.0F).data(), Scale(1.0));
  spread.AddView(Pose(900.0F).data(), missing);
  spread.AddView(Pose(900.0F).data(), Scale(-1.0));
  spread.EndFrame();
  spread.EndFrame();  // seen by no view
  const CanonicalReport report = spread.Finish().value();
  EXPECT_EQ(report.poses, 1);
  EXPECT_EQ(report.left_out, 1);
  EXPECT_NEAR(report.per_joint[1].second.std_mm, 0.0, 1e-9);
  EXPECT_TRUE(std::isnan(report.all.views_mm));
}

TEST(CanonicalTest, BodiesWithoutHipsAndNoPoseAtAll) {
  CanonicalSpread spread({"", {"Tail", "Snout"}, {-1, 0}, 0, {0, 1}});
  EXPECT_FALSE(spread.Finish().has_value());
  spread.AddView(std::vector<float>(6, 1.0F).data(), Scale(1.0));
  spread.EndFrame();
  EXPECT_FALSE(spread.Finish()->right_hip_std_mm.has_value());
}

}  // namespace
}  // namespace canonpose
