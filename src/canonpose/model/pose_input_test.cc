#include "canonpose/model/pose_input.h"

#include <cmath>

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "canonpose/base/random.h"

namespace canonpose {
namespace {

CameraView Wanderer(int frames, int joints) {
  Rng rng(1);
  CameraView view;
  view.image_size = {1920, 1080};
  for (int t = 0; t < frames; ++t) {
    const double x = rng.Uniform(200, 1700);
    const double y = rng.Uniform(300, 800);
    for (int j = 0; j < joints; ++j) {
      view.keypoints.push_back(static_cast<float>(x + rng.Uniform(-100, 100)));
      view.keypoints.push_back(static_cast<float>(y + rng.Uniform(-200, 200)));
      view.confidence.push_back(0.9F);
    }
  }
  return view;
}

TEST(PoseInput, OffIsPlainNormalisation) {
  const Skeleton& skeleton = *FindSkeleton("h36m-17");
  const CameraView view = Wanderer(3, 17);
  const PoseInput input({RayForm::kOff, FocalSource::kKnown}, skeleton);
  NormalisedPose pose;
  NormalisedPose plain;
  Eigen::Matrix3d turned_from_camera;
  ASSERT_TRUE(input.Normalise(view, 2, pose, turned_from_camera));
  ASSERT_TRUE(NormalisePose(&view.keypoints[2 * 34], &view.confidence[34], 17, skeleton.root, plain));
  EXPECT_EQ(pose.keypoints, plain.keypoints);
  EXPECT_EQ(turned_from_camera, Eigen::Matrix3d::Identity());
}

TEST(PoseInput, TheTurnTakesTheRootsRayToTheAxisWithTheCameraThatIsToBeUsed) {
  const Skeleton& skeleton = *FindSkeleton("h36m-17");
  CameraView view = Wanderer(3, 17);
  Camera calibrated;
  calibrated.K << 1100, 0, 900, 0, 1110, 600, 0, 0, 1;
  Camera solved;
  solved.K << 1200, 0, 960, 0, 1200, 540, 0, 0, 1;
  const auto expect_turn = [&](FocalSource focal, const Eigen::Matrix3d& K) {
    const PoseInput input({RayForm::kRoot, focal}, skeleton);
    NormalisedPose pose;
    Eigen::Matrix3d turned_from_camera;
    ASSERT_TRUE(input.Normalise(view, 1, pose, turned_from_camera));
    const std::size_t root = 17 + static_cast<std::size_t>(skeleton.root);
    const Eigen::Vector3d ray =
        K.inverse() * Eigen::Vector3d(view.keypoints[2 * root], view.keypoints[2 * root + 1], 1.0);
    EXPECT_NEAR((turned_from_camera * ray.normalized() - Eigen::Vector3d::UnitZ()).norm(), 0.0, 1e-6);
    EXPECT_GT((ray.normalized() - Eigen::Vector3d::UnitZ()).norm(), 0.01);
  };
  const double diagonal = std::hypot(1920.0, 1080.0);
  Eigen::Matrix3d guess;
  guess << diagonal, 0, 960, 0, diagonal, 540, 0, 0, 1;
  expect_turn(FocalSource::kKnown, guess);
  view.calibration = {calibrated};
  expect_turn(FocalSource::kKnown, calibrated.K);
  view.solved_calibration = {solved, solved, solved};
  expect_turn(FocalSource::kKnown, solved.K);
  expect_turn(FocalSource::kGuess, guess);
  const PoseInput input({RayForm::kRoot, FocalSource::kGuess}, skeleton);
  EXPECT_FALSE(input.LacksCamera(view));
  view.image_size = {0, 0};
  EXPECT_TRUE(input.LacksCamera(view));
  EXPECT_FALSE(PoseInput({RayForm::kOff, FocalSource::kGuess}, skeleton).LacksCamera(view));
}

}  // namespace
}  // namespace canonpose
