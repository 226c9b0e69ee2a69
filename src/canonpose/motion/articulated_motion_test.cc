#include "canonpose/motion/articulated_motion.h"

#include <numbers>
#include <vector>

#include <gtest/gtest.h>

namespace canonpose {
namespace {

using Eigen::Vector3d;

/// A trunk 500 mm high with an arm of 300 mm along x, in two frames: at rest, and with both rotated.
ArticulatedMotion RotatingArm() {
  ArticulatedMotion motion;
  motion.fps = 50.0;
  motion.joints = {
      {"root", -1, Vector3d::Zero()}, {"shoulder", 0, Vector3d(0, 0, 500)}, {"hand", 1, Vector3d(300, 0, 0)}};
  motion.root_position_mm = {Vector3d(10, 20, 1000), Vector3d(10, 20, 1000)};
  motion.parent_from_joint.assign(6, Eigen::Quaterniond::Identity());
  const double quarter = std::numbers::pi / 2.0;
  motion.parent_from_joint[3] = Eigen::AngleAxisd(quarter, Vector3d::UnitX());  // the trunk falls to -y
  motion.parent_from_joint[4] = Eigen::AngleAxisd(quarter, Vector3d::UnitZ());  // the arm, in the trunk's frame, to +y
  return motion;
}

TEST(ForwardKinematics, EachJointRotatesWhatFollowsIt) {
  const ArticulatedMotion motion = RotatingArm();
  std::vector<Vector3d> positions;
  std::vector<Eigen::Quaterniond> rotations;
  ForwardKinematics(motion, 1, positions, rotations);
  ASSERT_EQ(positions.size(), 3U);
  EXPECT_LT((positions[0] - Vector3d(10, 20, 1000)).norm(), 1e-9);
  EXPECT_LT((positions[1] - Vector3d(10, -480, 1000)).norm(), 1e-9);
  EXPECT_LT((positions[2] - Vector3d(10, -480, 1300)).norm(), 1e-9) << positions[2].transpose();
  EXPECT_LT((rotations[2] * Vector3d::UnitX() - Vector3d::UnitZ()).norm(), 1e-9);
}

TEST(RestPose, IsTheFrameWithoutRotationsRelativeToTheRoot) {
  const ArticulatedMotion motion = RotatingArm();
  const std::vector<Vector3d> rest = RestPose(motion);
  std::vector<Vector3d> positions;
  std::vector<Eigen::Quaterniond> rotations;
  ForwardKinematics(motion, 0, positions, rotations);
  ASSERT_EQ(rest.size(), 3U);
  for (std::size_t j = 0; j < rest.size(); ++j) EXPECT_EQ(rest[j], positions[j] - motion.root_position_mm[0]) << j;
}

}  // namespace
}  // namespace canonpose
