#include "canonpose/geometry/normalisation.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace canonpose {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

double Norm(const std::vector<float>& values) {
  double squares = 0.0;
  for (const float value : values) squares += static_cast<double>(value) * value;
  return std::sqrt(squares);
}

TEST(NormalisePose, CentresOnTheRootHasUnitNormAndIsPlanar) {
  const float keypoints[] = {10, 20, 13, 20, 10, 24};  // the root, 3 px right of it, 4 px below it
  const float confidence[] = {1.0F, 0.5F, 0.25F};
  NormalisedPose pose;
  ASSERT_TRUE(NormalisePose(keypoints, confidence, 3, 0, pose));
  const std::vector<float> expected = {0.0F, 0.6F, 0.0F, 0.0F, 0.0F, 0.8F};  // x of all, then y of all
  for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_NEAR(pose.keypoints[i], expected[i], 1e-6);
  EXPECT_EQ(pose.confidence, (std::vector<float>{1.0F, 0.5F, 0.25F}));
  EXPECT_NEAR(pose.scale_px, 5.0, 1e-5);
}

TEST(NormalisePose, MissingJointsAreZeroAndDoNotStretchTheOthers) {
  // Four joints at equal distances from the root: leaving one out does not move the others.
  const float all[] = {0, 0, 1, 0, 0, 1, -1, 0, 0, -1};
  const float seen_by_all[] = {1, 1, 1, 1, 1};
  NormalisedPose full;
  ASSERT_TRUE(NormalisePose(all, seen_by_all, 5, 0, full));
  const float some[] = {0, 0, 1, 0, 0, 1, -1, 0, kNan, kNan};
  const float seen_by_some[] = {1, 1, 1, 1, 0};
  NormalisedPose partial;
  ASSERT_TRUE(NormalisePose(some, seen_by_some, 5, 0, partial));
  EXPECT_NEAR(Norm(full.keypoints), 1.0, 1e-6);
  EXPECT_NEAR(Norm(partial.keypoints), std::sqrt(4.0 / 5.0), 1e-6);
  EXPECT_EQ(partial.keypoints[4], 0.0F);
  EXPECT_EQ(partial.confidence[4], 0.0F);
}

TEST(NormalisePose, RefusesUnusablePoses) {
  NormalisedPose pose;
  const float keypoints[] = {0, 0, 1, 0, 0, 1, 2, 2};
  const float no_root[] = {0, 1, 1, 1};
  EXPECT_FALSE(NormalisePose(keypoints, no_root, 4, 0, pose));
  const float one_of_four[] = {1, 0, 0, 0};
  EXPECT_FALSE(NormalisePose(keypoints, one_of_four, 4, 0, pose));
  const float same_place[] = {5, 5, 5, 5, 5, 5, 5, 5};
  const float all[] = {1, 1, 1, 1};
  EXPECT_FALSE(NormalisePose(same_place, all, 4, 0, pose));
  const float nan_root[] = {kNan, 0, 1, 0, 0, 1, 2, 2};
  EXPECT_FALSE(NormalisePose(nan_root, all, 4, 0, pose));
}

}  // namespace
}  // namespace canonpose
