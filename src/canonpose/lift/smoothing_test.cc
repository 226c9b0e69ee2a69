#include <cmath>
#include <vector>

#include <Eigen/Geometry>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/base/random.h"
#include "canonpose/base/testing.h"
#include "canonpose/lift/pose_lifter.h"

namespace canonpose {
namespace {

constexpr int kFrames = 60;
constexpr int kJoints = 3;

using testing::ErrorOf;
using ::testing::HasSubstr;
using Rotation = Eigen::Matrix<float, 3, 3, Eigen::RowMajor>;

float Quadratic(int frame, std::size_t value) {
  const double t = frame / 30.0;
  return static_cast<float>(0.1 * static_cast<double>(value) + 0.3 * t - 0.2 * t * t);
}

/// Coordinates that are quadratics in time, with noise, under rotations that turn.
LiftedPoses Moving(double noise) {
  LiftedPoses poses({"", {"Hip", "Knee", "Foot"}, {-1, 0, 1}, 0, {0, 1, 2}}, kFrames, "cam");
  poses.rotation.clear();
  Rng rng(5);
  for (int t = 0; t < kFrames; ++t) {
    const Eigen::Matrix3f rotation =
        Eigen::AngleAxisf(0.02F * static_cast<float>(t), Eigen::Vector3f::UnitY()).matrix();
    for (int i = 0; i < 9; ++i) poses.rotation.push_back(rotation(i / 3, i % 3));
    for (std::size_t i = 0; i < 3 * kJoints; ++i) {
      poses.pose_in_camera.positions()[3 * kJoints * static_cast<std::size_t>(t) + i] =
          Quadratic(t, i) + static_cast<float>(noise * rng.Normal());
    }
  }
  for (int t = 0; t < kFrames; ++t) {
    const Rotation rotation(&poses.rotation[9 * static_cast<std::size_t>(t)]);
    poses.canonical.PoseAt(t) = poses.pose_in_camera.PoseAt(t) * rotation;
  }
  return poses;
}

double RootMeanSquareError(const LiftedPoses& poses) {
  double squares = 0.0;
  const std::vector<float>& values = poses.pose_in_camera.positions();
  for (std::size_t i = 0; i < values.size(); ++i) {
    squares += std::pow(values[i] - Quadratic(static_cast<int>(i) / (3 * kJoints), i % (3 * kJoints)), 2);
  }
  return std::sqrt(squares / static_cast<double>(values.size()));
}

TEST(Smooth, KeepsSteadyMotionAndTakesNoiseAway) {
  LiftedPoses steady = Moving(0.0);
  Smooth(steady, 9);
  EXPECT_LT(RootMeanSquareError(steady), 1e-6);
  LiftedPoses noisy = Moving(0.05);
  const double before = RootMeanSquareError(noisy);
  Smooth(noisy, 9);
  // In the middle of nine frames a quadratic keeps 59 / 231 of the noise's variance.
  EXPECT_NEAR(RootMeanSquareError(noisy) / before, std::sqrt(59.0 / 231.0), 0.06);
}

TEST(Smooth, CanonicalPosesFollow) {
  LiftedPoses poses = Moving(0.05);
  Smooth(poses, 7);
  for (int t = 0; t < kFrames; ++t) {
    const Rotation rotation(&poses.rotation[9 * static_cast<std::size_t>(t)]);
    EXPECT_LT((poses.canonical.PoseAt(t) * rotation.transpose() - poses.pose_in_camera.PoseAt(t)).norm(), 1e-5);
  }
}

TEST(Smooth, AJointThatIsMissingTakesNoPart) {
  LiftedPoses poses = Moving(0.05);
  for (int t = 10; t < 40; t += 3) poses.pose_in_camera.PoseAt(t).row(2).setConstant(std::nanf(""));
  LiftedPoses whole = Moving(0.05);
  Smooth(poses, 9);
  Smooth(whole, 9);
  EXPECT_TRUE(poses.pose_in_camera.PoseAt(13).row(2).array().isNaN().all());
  EXPECT_TRUE(poses.canonical.PoseAt(13).row(2).array().isNaN().all());
  EXPECT_TRUE(poses.pose_in_camera.PoseAt(14).allFinite());
  EXPECT_TRUE(poses.canonical.PoseAt(14).allFinite());
  EXPECT_EQ(poses.pose_in_camera.PoseAt(13).row(1), whole.pose_in_camera.PoseAt(13).row(1));
}

TEST(Smooth, WindowsMustBeOddAndFitTheClip) {
  RequireSmoothing(9, 100);
  RequireSmoothing(5, 5);
  const auto refusal = [](int window, int frames) {
    return ErrorOf(ErrorKind::kInvalidArgument, [&] { RequireSmoothing(window, frames); });
  };
  EXPECT_THAT(refusal(8, 100),
              HasSubstr("`smooth`: expected an odd number of frames, 5 or more, found 8; give 7 or 9"));
  EXPECT_THAT(refusal(3, 100), HasSubstr("5 or more"));
  EXPECT_THAT(refusal(101, 100), HasSubstr("no more than the 100 frames of the clip"));
}

TEST(Smooth, GapsAreNotBridgedAndLoneFramesKeepTheirPose) {
  LiftedPoses poses = Moving(0.05);
  poses.pose_in_camera.PoseAt(20).setConstant(std::nanf(""));
  const LiftedPoses before = poses;
  // Frames 0-29, then, after a pause of a hundred frames, 30-33 alone, and another pause.
  for (int t = 30; t < kFrames; ++t) poses.frames[static_cast<std::size_t>(t)] += t < 34 ? 100 : 200;
  Smooth(poses, 9);
  EXPECT_TRUE(poses.pose_in_camera.PoseAt(20).array().isNaN().all());
  EXPECT_TRUE(poses.pose_in_camera.PoseAt(21).allFinite());
  for (int t = 30; t < 34; ++t) EXPECT_EQ(poses.pose_in_camera.PoseAt(t), before.pose_in_camera.PoseAt(t)) << t;
}

}  // namespace
}  // namespace canonpose
