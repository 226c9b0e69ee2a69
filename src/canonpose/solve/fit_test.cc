#include "canonpose/solve/fit.h"

#include <cmath>

#include <gtest/gtest.h>

#include "canonpose/solve/frame_choice.h"

namespace canonpose {
namespace {

/// Two clips of ten frames, four a second: three frames a block, since a fourth is more than half a second later.
CaptureObservations TwoClips() {
  CaptureObservations capture;
  capture.clips = {{0, 0, 10, 4.0, 0}, {1, 10, 10, 4.0, 0}};
  capture.frame_count = 20;
  return capture;
}

TEST(MeanOverBlocks, TakesFramesOfHalfASecondTogether) {
  const std::vector<double> values = {1, 2, 3, 7, 8, 9};
  const BlockMean found = MeanOverBlocks(TwoClips(), ConsecutiveFrames(0, 6), values);
  EXPECT_EQ(found.blocks, 2);
  EXPECT_DOUBLE_EQ(found.mean, 5.0);      // of 2 and 8
  EXPECT_DOUBLE_EQ(found.variance, 9.0);  // 18 / 2
}

TEST(MeanOverBlocks, BeginsAnewWithAClip) {
  const std::vector<double> values = {1, 1, 5, 7};
  const BlockMean found = MeanOverBlocks(TwoClips(), ConsecutiveFrames(8, 4), values);
  EXPECT_EQ(found.blocks, 2);
  EXPECT_DOUBLE_EQ(found.mean, 3.5);
}

TEST(MeanOverBlocks, LeavesOutWhatIsUnknown) {
  const double unknown = std::nan("");
  const std::vector<double> values = {1, unknown, 3, unknown, unknown, unknown, 4};
  const BlockMean found = MeanOverBlocks(TwoClips(), ConsecutiveFrames(0, 7), values);
  EXPECT_EQ(found.blocks, 2);
  EXPECT_DOUBLE_EQ(found.mean, 3.0);
}

TEST(MeanOverBlocks, OfNothingOrOneBlockHasNoVariance) {
  EXPECT_EQ(MeanOverBlocks(TwoClips(), {}, {}).blocks, 0);
  const BlockMean one = MeanOverBlocks(TwoClips(), std::vector<int>{3}, std::vector<double>{2.0});
  EXPECT_EQ(one.blocks, 1);
  EXPECT_EQ(one.mean, 2.0);
  EXPECT_EQ(one.variance, 0.0);
}

TEST(DistanceAtDepth, IsOfThePointFromTheRay) {
  // The ray of (0.1, 0) with focal length 2 is 0.15 to the right at depth 3.
  const Eigen::Vector3d point(0.15, 0.4, 3.0);
  EXPECT_DOUBLE_EQ(DistanceAtDepth(point, 2.0, {0.1, 0.0}), 0.4);
  EXPECT_DOUBLE_EQ(DistanceInFront(point, 2.0, {0.1, 0.0}), 0.4);
  EXPECT_TRUE(std::isnan(DistanceInFront(-point, 2.0, {0.1, 0.0})));
}

}  // namespace
}  // namespace canonpose
