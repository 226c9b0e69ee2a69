#include "canonpose/solve/invented.h"

#include <cmath>

#include <gtest/gtest.h>

#include "canonpose/solve/exact_rig_testing.h"
#include "canonpose/solve/frame_choice.h"

namespace canonpose {
namespace {

using testing::ExactRig;

constexpr double kNoise = 0.004;
constexpr int kJoint = 6;
constexpr int kFrames = 40;

/// A rig that sees kJoint with the confidence 0.1 in views 1 and 2, otherwise everything with 1.
ExactRig NoisyRig() {
  ExactRig rig = testing::MakeExactRig();
  testing::SeeJoints(rig.truth, kNoise, 21, rig.capture);
  for (int n = 0; n < kFrames; ++n) {
    for (const int v : {1, 2}) rig.capture.confidence[rig.capture.Index(n, v, kJoint)] = 0.1F;
  }
  return rig;
}

/// Moves keypoints of kJoint by 0.1 body units, in another direction in every frame.
void Invent(int view, int first, int last, ExactRig& rig) {
  for (int n = first; n <= last; ++n) {
    const double scale = rig.truth.ImageScale(n, view, rig.capture.skeleton.root);
    const std::size_t i = 2 * rig.capture.Index(n, view, kJoint);
    rig.capture.xy[i] += static_cast<float>(0.1 * scale * std::cos(n));
    rig.capture.xy[i + 1] += static_cast<float>(0.1 * scale * std::sin(n));
  }
}

int Remove(ExactRig& rig) {
  Solution solution;
  solution.estimate = rig.truth;
  solution.scales.observation = NoiseModel(kNoise);
  return RemoveInvented(ConsecutiveFrames(0, kFrames), solution, rig.capture);
}

TEST(RemoveInvented, RemovesWhatIsNowhereNearTheJoint) {
  ExactRig rig = NoisyRig();
  Invent(1, 0, kFrames - 1, rig);
  EXPECT_EQ(Remove(rig), kFrames);
  for (int n = 0; n < kFrames; ++n) {
    for (int v = 0; v < rig.capture.view_count(); ++v) {
      for (int j = 0; j < rig.capture.joint_count(); ++j) {
        EXPECT_EQ(rig.capture.Sees(n, v, j), !(v == 1 && j == kJoint)) << n << ' ' << v << ' ' << j;
      }
    }
    EXPECT_FALSE(rig.capture.At(n, 1, kJoint).allFinite());
  }
}

TEST(RemoveInvented, KeepsKeypointsOfLowConfidenceThatAreRight) {
  ExactRig rig = NoisyRig();
  EXPECT_EQ(Remove(rig), 0);
}

TEST(RemoveInvented, LeavesConfidentKeypointsToTheCheckOfCameras) {
  ExactRig rig = NoisyRig();
  Invent(3, 0, kFrames - 1, rig);
  EXPECT_EQ(Remove(rig), 0);
}

TEST(RemoveInvented, LeavesAFewOutliersToTheRobustLoss) {
  ExactRig rig = NoisyRig();
  Invent(1, 5, 12, rig);
  EXPECT_EQ(Remove(rig), 0);
}

TEST(RemoveInvented, RemovesUpToTheConfidenceThatSeparates) {
  ExactRig rig = NoisyRig();
  Invent(1, 0, 19, rig);
  for (int n = 20; n < kFrames; ++n) rig.capture.confidence[rig.capture.Index(n, 1, kJoint)] = 0.3F;
  EXPECT_EQ(Remove(rig), 20);
  for (int n = 0; n < kFrames; ++n) EXPECT_EQ(rig.capture.Sees(n, 1, kJoint), n >= 20) << n;
}

TEST(RemoveInvented, JudgesSomeFramesAndRemovesInAll) {
  ExactRig rig = NoisyRig();
  Invent(2, 0, kFrames - 1, rig);
  Solution solution;
  solution.estimate = rig.truth;
  solution.scales.observation = NoiseModel(kNoise);
  EXPECT_EQ(RemoveInvented(ConsecutiveFrames(0, kFrames / 2), solution, rig.capture), kFrames);
}

}  // namespace
}  // namespace canonpose
