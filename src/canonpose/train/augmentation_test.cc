#include "canonpose/train/augmentation.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace canonpose {
namespace {

/// A row of its own.
struct OwnRow {
  explicit OwnRow(std::size_t joints, std::uint64_t seed)
      : keypoints(2 * joints), confidence(joints), target(3 * joints), weight(joints) {
    Rng rng(seed);
    for (auto* values : {&keypoints, &confidence, &target, &weight}) {
      for (float& value : *values) value = static_cast<float>(rng.Uniform(0.1, 1.0));
    }
  }
  TrainingRow row() { return {keypoints.data(), confidence.data(), target.data(), weight.data()}; }

  std::vector<float> keypoints;
  std::vector<float> confidence;
  std::vector<float> target;
  std::vector<float> weight;
};

TEST(FlipRow, NegatesXAndSwapsPartnersAndTwiceIsNothing) {
  const Skeleton& skeleton = *FindSkeleton("h36m-17");
  const std::size_t joints = skeleton.joints.size();
  const OwnRow before(joints, 1);
  OwnRow after = before;
  FlipRow(skeleton, after.row());
  const auto left = static_cast<std::size_t>(*skeleton.Find("LKnee"));
  const auto right = static_cast<std::size_t>(*skeleton.Find("RKnee"));
  const auto head = static_cast<std::size_t>(*skeleton.Find("Head"));
  EXPECT_EQ(after.keypoints[left], -before.keypoints[right]);
  EXPECT_EQ(after.keypoints[joints + left], before.keypoints[joints + right]);
  EXPECT_EQ(after.confidence[right], before.confidence[left]);
  EXPECT_EQ(after.weight[right], before.weight[left]);
  EXPECT_EQ(after.target[head], -before.target[head]);
  EXPECT_EQ(after.target[2 * joints + left], before.target[2 * joints + right]);
  FlipRow(skeleton, after.row());
  EXPECT_EQ(after.keypoints, before.keypoints);
  EXPECT_EQ(after.confidence, before.confidence);
  EXPECT_EQ(after.target, before.target);
  EXPECT_EQ(after.weight, before.weight);
}

TEST(DropJoints, LosesOneToFourJointsAndNormalisesAsIfTheyHadNotBeenSeen) {
  const Skeleton& skeleton = *FindSkeleton("h36m-17");
  const std::size_t joints = skeleton.joints.size();
  const auto root = static_cast<std::size_t>(skeleton.root);
  std::vector<int> times_lost(6, 0);
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    OwnRow own(joints, seed);
    own.keypoints[root] = own.keypoints[joints + root] = 0.0F;
    const std::vector<float> before = own.keypoints;
    Rng rng(seed);
    DropJoints(skeleton, rng, own.row());
    std::vector<float> pixels;
    for (std::size_t j = 0; j < joints; ++j) {
      pixels.push_back(before[j]);
      pixels.push_back(before[joints + j]);
    }
    NormalisedPose expected;
    ASSERT_TRUE(NormalisePose(pixels.data(), own.confidence.data(), static_cast<int>(joints), skeleton.root, expected));
    for (std::size_t i = 0; i < 2 * joints; ++i) EXPECT_NEAR(own.keypoints[i], expected.keypoints[i], 1e-6);
    EXPECT_GT(own.confidence[root], 0.0F);
    const auto lost = std::count(own.confidence.begin(), own.confidence.end(), 0.0F);
    ASSERT_LE(lost, 4);
    ++times_lost[static_cast<std::size_t>(lost)];
  }
  EXPECT_EQ(times_lost[0], 0);
  for (std::size_t lost = 1; lost <= 4; ++lost) EXPECT_GT(times_lost[lost], 25) << lost;
}

TEST(DropJoints, KeepsHalfOfTheJoints) {
  const Skeleton& skeleton = *FindSkeleton("h36m-17");
  OwnRow own(17, 3);
  int seen = 17;
  for (int j = 16; seen > 9; --j) {
    if (j == skeleton.root) continue;
    const auto joint = static_cast<std::size_t>(j);
    own.confidence[joint] = own.keypoints[joint] = own.keypoints[17 + joint] = 0.0F;
    --seen;
  }
  Rng rng(1);
  DropJoints(skeleton, rng, own.row());
  EXPECT_EQ(std::count(own.confidence.begin(), own.confidence.end(), 0.0F), 8);
}

}  // namespace
}  // namespace canonpose
