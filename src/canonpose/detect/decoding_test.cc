#include "canonpose/detect/decoding.h"

#include <cmath>

#include <gtest/gtest.h>

namespace canonpose {
namespace {

constexpr float kNo = -8.0F;    // sigmoid 3e-4
constexpr float kYes = 2.0F;    // sigmoid 0.88
constexpr float kMaybe = 0.0F;  // sigmoid 0.5

FeatureMap Map(int height, int width, int channels, float value) {
  return {height, width, channels,
          std::vector<float>(
              static_cast<std::size_t>(height) * static_cast<std::size_t>(width) * static_cast<std::size_t>(channels),
              value)};
}

PoseMaps EmptyMaps(int height, int width) {
  return {Map(height, width, 17, kNo),  Map(height, width, 34, 0.0F), Map(height, width, 1, kNo),
          Map(height, width, 34, 0.5F), Map(height, width, 2, 0.0F),  Map(height, width, 2, 0.0F)};
}

float& At(FeatureMap& map, int y, int x, std::size_t channel) { return const_cast<float*>(map.At(y, x))[channel]; }

/// A person centred in a cell with all joints `down` cells below it.
void AddPerson(PoseMaps& maps, int y, int x, int down, float centre) {
  At(maps.centre, y, x, 0) = centre;
  At(maps.box_scale, y, x, 0) = 12.0F;
  At(maps.box_scale, y, x, 1) = 8.0F;
  for (std::size_t j = 0; j < kPoseJoints; ++j) {
    At(maps.regress, y, x, 2 * j) = static_cast<float>(down);
    At(maps.heat, y + down, x, j) = kYes;
  }
}

float Sigmoid(float value) { return 1.0F / (1.0F + std::exp(-value)); }

TEST(DecodeSinglePose, TakesTheCentreByWeightAndJointsByNearness) {
  PoseMaps maps = EmptyMaps(16, 16);
  AddPerson(maps, 8, 8, 2, kMaybe);
  At(maps.centre, 1, 1, 0) = kYes;  // somebody surer, at the border
  std::vector<float> weight(256, 0.01F);
  weight[8 * 16 + 8] = 1.0F;
  // A wrist that is surer but 6 cells away: sigmoid(6) / (6 + 1.8) < sigmoid(2) / 1.8.
  At(maps.heat, 10, 14, kLWrist) = 6.0F;
  At(maps.offset, 10, 8, 2 * kLWrist) = 0.25F;
  At(maps.offset, 10, 8, 2 * kLWrist + 1) = 0.75F;
  const DetectedPose pose = DecodeSinglePose(maps, weight);
  EXPECT_NEAR(pose.joints[kNose].position.x(), 8.5F / 16, 1e-6);
  EXPECT_NEAR(pose.joints[kNose].position.y(), 10.5F / 16, 1e-6);
  EXPECT_NEAR(pose.joints[kLWrist].position.x(), 8.75F / 16, 1e-6);
  EXPECT_NEAR(pose.joints[kLWrist].position.y(), 10.25F / 16, 1e-6);
  EXPECT_NEAR(pose.joints[kLWrist].score, Sigmoid(kYes), 1e-6);
  EXPECT_NEAR(pose.score, Sigmoid(kYes), 1e-5);
}

TEST(DecodeSinglePose, GoesFartherForAMuchSurerJoint) {
  PoseMaps maps = EmptyMaps(16, 16);
  AddPerson(maps, 8, 8, 0, kYes);
  At(maps.heat, 8, 8, kNose) = -2.0F;  // sigmoid 0.12 / 1.8 = 0.066
  At(maps.heat, 8, 11, kNose) = 2.0F;  // 0.88 / 4.8 = 0.18
  const DetectedPose pose = DecodeSinglePose(maps, std::vector<float>(256, 1.0F));
  EXPECT_NEAR(pose.joints[kNose].position.x(), 11.5F / 16, 1e-6);
}

TEST(DecodePoses, FindsPeopleTheSurestFirst) {
  PoseMaps maps = EmptyMaps(32, 32);
  AddPerson(maps, 10, 6, 1, kMaybe);
  AddPerson(maps, 20, 24, 1, kYes);
  At(maps.centre, 21, 25, 0) = kMaybe;  // beside a peak
  const std::vector<DetectedPose> poses = DecodePoses(maps, 0.1F);
  ASSERT_EQ(poses.size(), 2U);
  EXPECT_NEAR(poses[0].joints[kNose].position.x(), 24.5F / 32, 1e-6);
  EXPECT_NEAR(poses[0].joints[kNose].position.y(), 21.5F / 32, 1e-6);
  EXPECT_NEAR(poses[0].joints[kNose].score, Sigmoid(kYes), 1e-5) << "just where it is expected";
  EXPECT_NEAR(poses[0].score, Sigmoid(kYes) * Sigmoid(kYes), 1e-5);
  EXPECT_NEAR(poses[1].score, Sigmoid(kMaybe) * Sigmoid(kYes), 1e-5);
}

TEST(DecodePoses, LooksForJointsInTheBoxAndLessFarAway) {
  PoseMaps maps = EmptyMaps(32, 32);
  AddPerson(maps, 16, 16, 0, kYes);
  At(maps.heat, 16, 16, kNose) = kNo;
  At(maps.heat, 16, 25, kNose) = 8.0F;  // outside the box, which is 8 cells wide
  At(maps.heat, 18, 16, kNose) = kYes;  // inside, 2 cells off
  const DetectedPose pose = DecodePoses(maps, 0.1F).at(0);
  EXPECT_NEAR(pose.joints[kNose].position.x(), 16.5F / 32, 1e-6);
  EXPECT_NEAR(pose.joints[kNose].score, Sigmoid(kYes) * std::exp(-4.0F / (0.3F * 32.0F)), 1e-3);
}

TEST(DecodePoses, LeavesOutWeakCentresAndMoreThanSix) {
  PoseMaps maps = EmptyMaps(64, 64);
  EXPECT_TRUE(DecodePoses(maps, 0.1F).empty());
  for (int i = 0; i < 8; ++i) AddPerson(maps, 10 + 20 * (i / 4), 8 + 14 * (i % 4), 0, kYes);
  EXPECT_EQ(DecodePoses(maps, 0.1F).size(), 6U);
}

TEST(DecodePoses, FindsNoJointsInABoxThatIsNoNumber) {
  for (const float damaged : {std::nanf(""), HUGE_VALF, -HUGE_VALF}) {
    PoseMaps maps = EmptyMaps(32, 32);
    AddPerson(maps, 16, 16, 0, kYes);
    At(maps.box_scale, 16, 16, 0) = damaged;
    const std::vector<DetectedPose> poses = DecodePoses(maps, 0.1F);
    ASSERT_EQ(poses.size(), 1U);
    EXPECT_EQ(poses[0].joints[kNose].score, 0.0F);
  }
}

TEST(Decoding, ChecksSizes) {
  PoseMaps maps = EmptyMaps(16, 16);
  EXPECT_THROW((void)DecodeSinglePose(maps, std::vector<float>(4, 1.0F)), std::logic_error);
  maps.offset = Map(8, 16, 34, 0.0F);
  EXPECT_THROW((void)DecodePoses(maps, 0.1F), std::logic_error);
}

}  // namespace
}  // namespace canonpose
