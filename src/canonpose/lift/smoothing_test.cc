#include <cmath>
#include <numeric>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "canonpose/base/random.h"
#include "canonpose/lift/lifter.h"

namespace canonpose {
namespace {

constexpr int kFrames = 60;
constexpr int kJoints = 3;

using Rows = Eigen::Matrix<float, kJoints, 3, Eigen::RowMajor>;
using Rotation = Eigen::Matrix<float, 3, 3, Eigen::RowMajor>;

std::vector<std::int64_t> Numbers(int first, int count) {
  std::vector<std::int64_t> frames(static_cast<std::size_t>(count));
  std::iota(frames.begin(), frames.end(), first);
  return frames;
}

float Quadratic(int frame, std::size_t value) {
  const double t = frame / 30.0;
  return static_cast<float>(0.1 * static_cast<double>(value) + 0.3 * t - 0.2 * t * t);
}

/// Coordinates that are quadratics in time, with noise, under rotations that turn.
LiftedPoses Moving(double noise) {
  LiftedPoses poses{kFrames, kJoints, {}, {}, {}};
  Rng rng(5);
  for (int t = 0; t < kFrames; ++t) {
    const Eigen::Matrix3f rotation =
        Eigen::AngleAxisf(0.02F * static_cast<float>(t), Eigen::Vector3f::UnitY()).matrix();
    for (int i = 0; i < 9; ++i) poses.rotation.push_back(rotation(i / 3, i % 3));
    for (std::size_t i = 0; i < 3 * kJoints; ++i) {
      poses.pose_in_camera.push_back(Quadratic(t, i) + static_cast<float>(noise * rng.Normal()));
    }
  }
  poses.canonical.resize(poses.pose_in_camera.size());
  for (std::size_t t = 0; t < kFrames; ++t) {
    const Rotation rotation(&poses.rotation[9 * t]);
    Eigen::Map<Rows>(&poses.canonical[3 * kJoints * t]) = Rows(&poses.pose_in_camera[3 * kJoints * t]) * rotation;
  }
  return poses;
}

double RootMeanSquareError(const LiftedPoses& poses) {
  double squares = 0.0;
  for (std::size_t i = 0; i < poses.pose_in_camera.size(); ++i) {
    squares += std::pow(poses.pose_in_camera[i] - Quadratic(static_cast<int>(i) / (3 * kJoints), i % (3 * kJoints)), 2);
  }
  return std::sqrt(squares / static_cast<double>(poses.pose_in_camera.size()));
}

TEST(Smooth, KeepsSteadyMotionAndTakesNoiseAway) {
  LiftedPoses steady = Moving(0.0);
  Smooth(steady, Numbers(0, kFrames), 9);
  EXPECT_LT(RootMeanSquareError(steady), 1e-6);
  LiftedPoses noisy = Moving(0.05);
  const double before = RootMeanSquareError(noisy);
  Smooth(noisy, Numbers(0, kFrames), 9);
  // In the middle of nine frames a quadratic keeps 59 / 231 of the noise's variance.
  EXPECT_NEAR(RootMeanSquareError(noisy) / before, std::sqrt(59.0 / 231.0), 0.06);
}

TEST(Smooth, CanonicalPosesFollow) {
  LiftedPoses poses = Moving(0.05);
  Smooth(poses, Numbers(0, kFrames), 7);
  for (std::size_t t = 0; t < kFrames; ++t) {
    const Rotation rotation(&poses.rotation[9 * t]);
    const Rows expected(&poses.pose_in_camera[3 * kJoints * t]);
    const Rows found = Rows(&poses.canonical[3 * kJoints * t]) * rotation.transpose();
    EXPECT_LT((found - expected).norm(), 1e-5);
  }
}

TEST(Smooth, GapsAreNotBridgedAndLoneFramesKeepTheirPose) {
  LiftedPoses poses = Moving(0.05);
  const auto at = [&](int t) { return poses.pose_in_camera.begin() + 3 * kJoints * t; };
  std::fill(at(20), at(21), std::nanf(""));
  const LiftedPoses before = poses;
  // Frames 0-29, then, after a pause of a hundred frames, 30-33 alone, and another pause.
  std::vector<std::int64_t> frames = Numbers(0, kFrames);
  for (int t = 30; t < kFrames; ++t) frames[static_cast<std::size_t>(t)] += t < 34 ? 100 : 200;
  Smooth(poses, frames, 9);
  for (std::size_t i = 0; i < 3 * kJoints; ++i) {
    EXPECT_TRUE(std::isnan(poses.pose_in_camera[20 * 3 * kJoints + i]));
    EXPECT_TRUE(std::isfinite(poses.pose_in_camera[21 * 3 * kJoints + i]));
    for (std::size_t t = 30; t < 34; ++t) {
      EXPECT_EQ(poses.pose_in_camera[t * 3 * kJoints + i], before.pose_in_camera[t * 3 * kJoints + i]);
    }
  }
}

}  // namespace
}  // namespace canonpose
