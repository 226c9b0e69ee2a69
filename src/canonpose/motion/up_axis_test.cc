#include "canonpose/motion/up_axis.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/base/testing.h"
#include "canonpose/motion/motion_testing.h"

namespace canonpose {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;
using testing::CollectedMessages;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using testing::PositionsByName;

/// Somebody who walks about and nods, with ankles near the ground.
ArticulatedMotion Walker() {
  ArticulatedMotion motion;
  motion.joints = {{"Hips", -1, {0, 0, 0}},
                   {"Head", 0, {0, 0, 700}},
                   {"LeftFoot", 0, {100, 0, -850}},
                   {"RightFoot", 0, {-100, 0, -850}}};
  for (int t = 0; t < 50; ++t) {
    motion.root_position_mm.emplace_back(40.0 * t, 10.0 * t, 930.0);
    for (int j = 0; j < 4; ++j) {
      motion.parent_from_joint.emplace_back(Eigen::AngleAxisd(0.1 * std::sin(0.3 * t + j), Vector3d::UnitX()));
    }
  }
  return motion;
}

/// The motion as it is read from a file in another frame: `world` turns all of it, `rest` its rest pose.
ArticulatedMotion Turned(const Quaterniond& world, const Quaterniond& rest) {
  ArticulatedMotion motion = Walker();
  for (MotionJoint& joint : motion.joints) joint.offset_mm = rest * joint.offset_mm;
  for (Vector3d& position : motion.root_position_mm) position = world * position;
  for (std::size_t i = 0; i < motion.parent_from_joint.size(); ++i) {
    Quaterniond& rotation = motion.parent_from_joint[i];
    rotation = (i % 4 == 0 ? world : rest) * rotation * rest.conjugate();
  }
  return motion;
}

Quaterniond About(const Vector3d& axis, double degrees) {
  return Quaterniond(Eigen::AngleAxisd(degrees / 180.0 * 3.14159265358979, axis));
}

void ExpectUpright(const ArticulatedMotion& motion) {
  for (int t = 0; t < motion.frame_count(); t += 7) {
    const auto at = PositionsByName(motion, t);
    EXPECT_GT(at.at("Head").z(), 1500.0);
    EXPECT_LT(std::abs(at.at("LeftFoot").z()), 200.0);
    EXPECT_NEAR((at.at("Head") - at.at("Hips")).norm(), 700.0, 1e-6);
  }
}

TEST(StandUpright, LeavesUprightMotionAlone) {
  ArticulatedMotion motion = Walker();
  const CollectedMessages messages;
  StandUpright(motion, "a.bvh");
  EXPECT_THAT(messages.text(), IsEmpty());
  EXPECT_EQ(motion.root_position_mm[9], Walker().root_position_mm[9]);
}

TEST(StandUpright, TheRestPoseAndTheMotionShowTheAxis) {
  for (const auto& [turn, name] : {std::pair(About(Vector3d::UnitX(), 90), "z points up"),
                                   std::pair(About(Vector3d::UnitX(), -90), "-z points up"),
                                   std::pair(About(Vector3d::UnitY(), 90), "x points up"),
                                   std::pair(About(Vector3d::UnitX(), 180), "-y points up")}) {
    ArticulatedMotion motion = Turned(turn, turn);
    const CollectedMessages messages;
    StandUpright(motion, "a.bvh");
    ExpectUpright(motion);
    EXPECT_THAT(messages.text(), HasSubstr(name));
    EXPECT_THAT(messages.text(), Not(HasSubstr("warning")));
    EXPECT_GT(RestPose(motion)[1].z(), 690.0);
  }
}

TEST(StandUpright, WithoutTheRestPoseItWarns) {
  const Quaterniond none = Quaterniond::Identity();
  ArticulatedMotion upside_down = Turned(About(Vector3d::UnitY(), 180), none);
  const CollectedMessages messages;
  StandUpright(upside_down, "a.bvh");
  ExpectUpright(upside_down);
  EXPECT_THAT(messages.text(), HasSubstr("warning: a.bvh: with y up the person stands on the head all the time"));
  ArticulatedMotion z_up = Turned(About(Vector3d::UnitX(), 90), none);
  StandUpright(z_up, "b.bvh");
  ExpectUpright(z_up);
  EXPECT_THAT(messages.text(), HasSubstr("warning: b.bvh: with y up the person lies all the time, so z is taken"));
}

TEST(StandUpright, SomebodyWhoLiesStaysThere) {
  ArticulatedMotion motion = Turned(About(Vector3d::UnitX(), 90), Quaterniond::Identity());
  for (Vector3d& position : motion.root_position_mm) position = {300.0, 1700.0, 100.0};
  const ArticulatedMotion before = motion;
  const CollectedMessages messages;
  StandUpright(motion, "a.bvh");
  EXPECT_EQ(motion.root_position_mm[0], before.root_position_mm[0]);
  EXPECT_THAT(messages.text(), HasSubstr("warning: a.bvh: the person lies all the time, head towards z"));
}

}  // namespace
}  // namespace canonpose
