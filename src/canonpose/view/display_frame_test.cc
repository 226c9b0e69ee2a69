#include "canonpose/view/display_frame.h"

#include <algorithm>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "canonpose/base/testing.h"
#include "canonpose/view/page_testing.h"

namespace canonpose {
namespace {

Eigen::Vector3d JointOf(const Scene& scene, int frame, const std::string& joint) {
  const PoseSequence& person = scene.people.front();
  return person.PoseAt(frame).row(person.skeleton().Find(joint).value()).transpose().cast<double>();
}

/// The scene after a similarity: turned, scaled and moved, with its cameras.
Scene Moved(Scene scene, const Eigen::Matrix3d& turn, double scale, const Eigen::Vector3d& shift) {
  for (PoseSequence& person : scene.people) {
    for (int t = 0; t < person.frame_count(); ++t) {
      for (int j = 0; j < person.joint_count(); ++j) {
        const Eigen::Vector3d point = person.PoseAt(t).row(j).transpose().cast<double>();
        person.PoseAt(t).row(j) = (scale * (turn * point) + shift).transpose().cast<float>();
      }
    }
    person.unit = LengthUnit::kBodyLengths;
  }
  for (SceneCamera& camera : scene.cameras) {
    for (Camera& calibration : camera.calibration) {
      const Eigen::Matrix3d rotation = calibration.camera_from_world_rotation * turn.transpose();
      calibration.camera_from_world_translation = scale * calibration.camera_from_world_translation - rotation * shift;
      calibration.camera_from_world_rotation = rotation;
    }
  }
  return scene;
}

Scene LyingScene() {
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(2.0, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  Scene scene = Moved(testing::WalkingScene(1, 60).scene, turn, 0.001, {3, -2, 5});
  scene.up = {};
  return scene;
}

TEST(DisplayFrame, KeepsAWorldWhoseUpIsKnown) {
  const Scene scene = testing::WalkingScene(1, 20).scene;
  const DisplayFrame frame = MakeDisplayFrame(scene);
  EXPECT_FALSE(frame.up_is_guess);
  EXPECT_FALSE(frame.floor_is_guess);
  EXPECT_TRUE(frame.is_metric);
  EXPECT_LT((frame.Show({1000, 2000, 3000}) - Eigen::Vector3d(1, 2, 3)).norm(), 1e-9);
}

TEST(DisplayFrame, TakesUpFromTheCamerasWhereItIsUnknown) {
  const Scene scene = LyingScene();
  const DisplayFrame frame = MakeDisplayFrame(scene);
  EXPECT_TRUE(frame.up_is_guess);
  EXPECT_TRUE(frame.floor_is_guess);
  // The cameras look down by 8 degrees from all sides, which averages out.
  const Eigen::Vector3d spine = frame.Show(JointOf(scene, 0, "Thorax")) - frame.Show(JointOf(scene, 0, "Hip"));
  EXPECT_GT(spine.normalized().z(), std::cos(3.0 * 3.14159 / 180.0));
}

TEST(DisplayFrame, PutsFeetOnTheFloorAndAdultsToTheirSize) {
  const Scene scene = LyingScene();
  const DisplayFrame frame = MakeDisplayFrame(scene);
  EXPECT_FALSE(frame.is_metric);
  double lowest = 10.0;
  for (const char* foot : {"LFoot", "RFoot"}) lowest = std::min(lowest, frame.Show(JointOf(scene, 30, foot)).z());
  EXPECT_NEAR(lowest, 0.08, 0.06);  // an ankle
  EXPECT_NEAR(frame.Show(JointOf(scene, 30, "Head")).z(), 1.65, 0.25);
}

TEST(DisplayFrame, LaysAnotherResultUponTheFirst) {
  const Scene scene = testing::WalkingScene(1, 60).scene;
  const Scene other = LyingScene();
  const DisplayFrame frame = MakeDisplayFrame(scene);
  const DisplayFrame like = MakeDisplayFrameLike(scene, frame, other);
  EXPECT_FALSE(like.up_is_guess);
  for (const char* joint : {"Hip", "Head", "LWrist", "RFoot"}) {
    EXPECT_LT((frame.Show(JointOf(scene, 40, joint)) - like.Show(JointOf(other, 40, joint))).norm(), 1e-3) << joint;
  }
}

TEST(DisplayFrame, OfAnotherResultIsItsOwnWhereNothingIsCommon) {
  const Scene scene = testing::WalkingScene(1, 60).scene;
  Scene other = LyingScene();
  for (PoseSequence& person : other.people) {
    person = PoseSequence({"", {"a", "b"}, {-1, 0}, 0, {0, 1}}, 60);
  }
  EXPECT_TRUE(MakeDisplayFrameLike(scene, MakeDisplayFrame(scene), other).up_is_guess);
}

TEST(DisplayFrame, OfNobodyKnownIsFinite) {
  Scene scene;
  scene.people.emplace_back(*FindSkeleton("h36m-17"), 5);
  const DisplayFrame frame = MakeDisplayFrame(scene);
  EXPECT_TRUE(frame.rotation.allFinite() && frame.origin.allFinite() && std::isfinite(frame.scale));
}

TEST(BoneLengthSum, IsThatOfTheMedianBones) {
  PoseSequence person({"", {"a", "b", "c"}, {-1, 0, 1}, 0, {0, 1, 2}}, std::vector<float>{0, 0, 0, 3, 0, 0, 3, 4, 0});
  EXPECT_DOUBLE_EQ(BoneLengthSum(person), 7.0);
}

}  // namespace
}  // namespace canonpose
