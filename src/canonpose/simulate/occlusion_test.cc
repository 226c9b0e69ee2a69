#include "canonpose/simulate/occlusion.h"

#include <gtest/gtest.h>

#include "canonpose/base/random.h"
#include "canonpose/simulate/figure_testing.h"

namespace canonpose {
namespace {

std::vector<std::uint8_t> Hidden(const std::array<Eigen::Vector3d, kLandmarkCount>& figure,
                                 const Eigen::Vector3d& camera_mm) {
  const OcclusionTest test(MapLayout(LandmarkSkeleton(), LandmarkSkeleton()));
  std::vector<std::uint8_t> hidden(kLandmarkCount);
  test.Find(figure.data(), figure.data(), camera_mm, StatureMm(figure.data()), hidden.data());
  return hidden;
}

const Eigen::Vector3d kFront(5000, 0, 1200);
const Eigen::Vector3d kBack(-5000, 0, 1200);
const Eigen::Vector3d kLeft(0, 5000, 1200);

TEST(Occlusion, TrunkHidesAWristBehindItAndNotOneInFront) {
  auto figure = testing::StandingFigure();
  figure[kRWrist] = {-200, 0, 1150};
  EXPECT_EQ(Hidden(figure, kFront)[kRWrist], 1);
  EXPECT_EQ(Hidden(figure, kBack)[kRWrist], 0);
  figure[kRWrist] = {250, 0, 1150};
  EXPECT_EQ(Hidden(figure, kFront)[kRWrist], 0);
  EXPECT_EQ(Hidden(figure, kBack)[kRWrist], 1);
}

TEST(Occlusion, FrontViewOfAStandingPersonShowsAllButTheHeels) {
  const auto hidden = Hidden(testing::StandingFigure(), kFront);
  for (int j = 0; j < kLandmarkCount; ++j) {
    if (j == kLHeel || j == kRHeel || j == kLEar || j == kREar) continue;
    EXPECT_EQ(hidden[static_cast<std::size_t>(j)], 0) << LandmarkSkeleton().joints[static_cast<std::size_t>(j)];
  }
  EXPECT_EQ(Hidden(testing::StandingFigure(), kBack)[kNose], 1);
}

TEST(Occlusion, SideViewHidesTheOtherSide) {
  auto figure = testing::StandingFigure();
  // Forearms forward, or the nearer one would hide the pelvis.
  testing::Swing(figure, kLElbow, {kLWrist}, 90.0);
  testing::Swing(figure, kRElbow, {kRWrist}, 90.0);
  const auto hidden = Hidden(figure, kLeft);
  for (const Landmark j : {kRHip, kRKnee, kRShoulder, kRElbow, kRWrist}) EXPECT_EQ(hidden[j], 1) << j;
  for (const Landmark j : {kLHip, kLKnee, kLFoot, kLShoulder, kLElbow, kLWrist, kHead, kHip})
    EXPECT_EQ(hidden[j], 0) << j;
}

TEST(Occlusion, SegmentDistanceIsTheSmallestOfAllPointsPairs) {
  Rng rng(1);
  const auto point = [&] { return Eigen::Vector3d(rng.Normal(), rng.Normal(), rng.Normal()); };
  for (int i = 0; i < 50; ++i) {
    const Eigen::Vector3d p0 = point();
    const Eigen::Vector3d p1 = point();
    const Eigen::Vector3d q0 = point();
    const Eigen::Vector3d q1 = i % 10 == 0 ? q0 : point();
    double least = 1e9;
    for (int s = 0; s <= 100; ++s) {
      for (int t = 0; t <= 100; ++t) {
        least = std::min(least, (p0 + (p1 - p0) * s / 100.0 - q0 - (q1 - q0) * t / 100.0).norm());
      }
    }
    EXPECT_NEAR(std::sqrt(SegmentDistanceSquared(p0, p1, q0, q1)), least, 0.03);
  }
}

}  // namespace
}  // namespace canonpose
