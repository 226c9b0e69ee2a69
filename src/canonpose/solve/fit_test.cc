#include "canonpose/solve/fit.h"

#include <cmath>

#include <gtest/gtest.h>

#include "canonpose/solve/exact_rig_testing.h"
#include "canonpose/solve/frame_choice.h"

namespace canonpose {
namespace {

using testing::ExactRig;
using testing::ExactRigOptions;
using testing::MakeExactRig;

/// Two clips of ten frames at 4 Hz. A block is three frames, since the fourth is more than half a second after the
/// first.
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

TEST(CauchyWeight, IsTheDerivativeOfTheLoss) {
  EXPECT_DOUBLE_EQ(CauchyWeight(0.0), 1.0);
  for (const double error : {0.5, 2.0, 7.0}) {
    constexpr double kStep = 1e-5;
    const double by_square =
        (CauchyLoss(std::sqrt(error * error + kStep)) - CauchyLoss(std::sqrt(error * error - kStep))) / (2.0 * kStep);
    EXPECT_NEAR(CauchyWeight(error), kLossScale * kLossScale * by_square, 1e-6) << error;
  }
}

constexpr double kNoise = 0.004;

ExactRig NoisyRig(int frames) {
  ExactRigOptions options;
  options.frames = frames;
  ExactRig rig = MakeExactRig(options);
  testing::SeeJoints(rig.truth, kNoise, 11, rig.capture);
  return rig;
}

TEST(VisitErrors, GivesTheErrorOfEveryKeypointInBodyUnits) {
  ExactRig rig = MakeExactRig();
  testing::Hide(rig.capture, 2, 1, 5);
  rig.truth.Joint(2, 6).setConstant(std::nan(""));
  const std::size_t i = 2 * rig.capture.Index(2, 3, 4);
  rig.capture.xy[i] += static_cast<float>(0.05 * rig.truth.ImageScale(2, 3, rig.capture.skeleton.root));
  int count = 0;
  VisitErrors(rig.capture, std::vector<int>{2}, rig.truth, [&](int n, int v, int j, double error) {
    ++count;
    EXPECT_EQ(n, 2);
    EXPECT_NEAR(error, v == 3 && j == 4 ? 0.05 : 0.0, 1e-6) << v << ' ' << j;
  });
  EXPECT_EQ(count, 4 * 16 - 1);
}

TEST(MeasureNoise, FindsTheNoiseThatWasAdded) {
  const ExactRig rig = NoisyRig(100);
  const NoiseModel noise = MeasureNoise(rig.capture, ConsecutiveFrames(0, 100), rig.truth);
  EXPECT_NEAR(noise.Typical(), kNoise, 0.03 * kNoise);
  for (int j = 0; j < rig.capture.joint_count(); ++j) EXPECT_NEAR(noise.Scatter(j, 1.0), kNoise, 0.2 * kNoise) << j;
}

TEST(MeasureAccelerations, SeparatesThemFromErrors) {
  ExactRigOptions options;
  options.frames = 2000;
  ExactRig rig = MakeExactRig(options);
  constexpr double kAcceleration = 0.002;
  Rng rng(13);
  for (int j = 0; j < rig.truth.joint_count; ++j) {
    // Joint 0 stands still; the others have an acceleration that is constant for 20 frames at a time. All have errors.
    Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
    Eigen::Vector3d at = Eigen::Vector3d::Zero();
    Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();
    for (int n = 0; n < 2000; ++n) {
      if (n % 20 == 0 && j > 0)
        acceleration = kAcceleration * Eigen::Vector3d(rng.Normal(), rng.Normal(), rng.Normal());
      velocity += acceleration;
      at += velocity;
      rig.truth.Joint(n, j) = at + 0.001 * Eigen::Vector3d(rng.Normal(), rng.Normal(), rng.Normal());
    }
  }
  const std::vector<double> found = MeasureAccelerations(rig.capture, rig.truth);
  EXPECT_LT(found[0], 0.1 * kAcceleration);
  for (std::size_t j = 1; j < found.size(); ++j) EXPECT_NEAR(found[j], kAcceleration, 0.35 * kAcceleration) << j;
}

TEST(MeasureAngularVelocity, IsTwiceTheRotationOfASecondPerAxis) {
  ExactRigOptions options;
  options.static_cameras = false;
  options.frames = 60;
  options.turn_rad_per_s = 0.4;
  const ExactRig rig = MakeExactRig(options);
  const double found = MeasureAngularVelocity(rig.capture, ConsecutiveFrames(0, 60), rig.truth);
  EXPECT_NEAR(found, 2.0 * 0.4 / 1.54, 1e-6);
  // Runs of less than half a second say nothing.
  EXPECT_EQ(MeasureAngularVelocity(rig.capture, ConsecutiveFrames(0, 12), rig.truth),
            AdjustmentScales{}.angular_velocity);
}

TEST(Preference, IsForTheSolutionThatExplainsMore) {
  const ExactRig rig = NoisyRig(100);
  Solution good;
  good.estimate = rig.truth;
  good.scales.observation = NoiseModel(kNoise);
  Solution bad = good;
  bad.scales.observation = NoiseModel(2.0 * kNoise);
  Rng rng(14);
  for (Eigen::Vector3d& joint : bad.estimate.joints) joint.x() += 2.0 * kNoise * rng.Normal();
  const std::vector<int> frames = ConsecutiveFrames(0, 100);
  EXPECT_GT(Preference(rig.capture, frames, good, bad), 4.0);
  EXPECT_DOUBLE_EQ(Preference(rig.capture, frames, bad, good), -Preference(rig.capture, frames, good, bad));
  EXPECT_EQ(Preference(rig.capture, frames, good, good), 0.0);
  EXPECT_EQ(Preference(rig.capture, ConsecutiveFrames(0, 5), good, bad), 0.0);  // one block
}

}  // namespace
}  // namespace canonpose
