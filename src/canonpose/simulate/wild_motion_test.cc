#include "canonpose/simulate/wild_motion.h"

#include <cmath>

#include <gtest/gtest.h>

#include "canonpose/geometry/angles.h"
#include "canonpose/simulate/people/body.h"
#include "canonpose/simulate/people/stage.h"
#include "canonpose/simulate/procedural.h"

namespace canonpose {
namespace {

/// Options that change nothing.
WildOptions Tame() { return {0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0}; }

ArticulatedMotion Make(Activity activity, std::uint64_t seed, int frames = 40) {
  return MakeProceduralMotion({activity, 3, seed, 5.0, frames, "clip", "person"});
}

Eigen::Quaterniond Local(const ArticulatedMotion& motion, int frame, int joint) {
  return motion.parent_from_joint[static_cast<std::size_t>(frame * motion.joint_count() + joint)];
}

std::vector<Eigen::Vector3d> Positions(const ArticulatedMotion& motion, int frame) {
  std::vector<Eigen::Vector3d> positions;
  std::vector<Eigen::Quaterniond> rotations;
  ForwardKinematics(motion, frame, positions, rotations);
  return positions;
}

TEST(WildMotion, KeepsRotationsAndHingesValid) {
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    ArticulatedMotion motion = Make(Activity::kJump, seed);
    MakeWild(motion, {}, Rng(seed));
    for (int f = 0; f < motion.frame_count(); ++f) {
      for (int j = 0; j < motion.joint_count(); ++j) ASSERT_NEAR(Local(motion, f, j).norm(), 1.0, 1e-9);
      for (const int side : {kLeft, kRight}) {
        const Eigen::Quaterniond knee = Local(motion, f, LegJoint(kBLKnee, side));
        const Eigen::Quaterniond elbow = Local(motion, f, ArmJoint(kBLElbow, side));
        ASSERT_LT(std::hypot(knee.x(), knee.z()), 1e-9);
        ASSERT_LT(std::hypot(elbow.x(), elbow.z()), 1e-9);
        const double knee_deg = DegFromRad(2.0 * std::atan2(knee.y(), knee.w()));
        const double elbow_deg = DegFromRad(-2.0 * std::atan2(elbow.y(), elbow.w()));
        ASSERT_GE(knee_deg, -1e-9);
        ASSERT_LE(knee_deg, 148.0 + 1e-9);
        ASSERT_GE(elbow_deg, -1e-9);
        ASSERT_LE(elbow_deg, 145.0 + 1e-9);
      }
    }
  }
}

TEST(WildMotion, IsTheSameForTheSameSeedOnly) {
  const ArticulatedMotion tame = Make(Activity::kGait, 1);
  ArticulatedMotion a = tame;
  ArticulatedMotion b = tame;
  ArticulatedMotion c = tame;
  MakeWild(a, {}, Rng(5));
  MakeWild(b, {}, Rng(5));
  MakeWild(c, {}, Rng(6));
  double difference = 0.0;
  for (std::size_t i = 0; i < a.parent_from_joint.size(); ++i) {
    EXPECT_EQ(a.parent_from_joint[i].coeffs(), b.parent_from_joint[i].coeffs());
    difference = std::max(difference, a.parent_from_joint[i].angularDistance(c.parent_from_joint[i]));
  }
  EXPECT_GT(difference, 0.1);
}

TEST(WildMotion, WithoutAnyChangeOnlyTheBodyTiltsALittle) {
  const ArticulatedMotion tame = Make(Activity::kGait, 1);
  ArticulatedMotion motion = tame;
  MakeWild(motion, Tame(), Rng(5));
  for (int f = 0; f < motion.frame_count(); ++f) {
    EXPECT_LT(Local(motion, f, 0).angularDistance(Local(tame, f, 0)), RadFromDeg(25.0));
    for (int j = 1; j < motion.joint_count(); ++j) {
      ASSERT_LT(Local(motion, f, j).angularDistance(Local(tame, f, j)), 1e-7) << motion.joints[std::size_t(j)].name;
    }
  }
}

TEST(WildMotion, RaisedArmsAreAboveTheShoulders) {
  WildOptions options = Tame();
  options.arms_raised = 1.0;
  int above = 0;
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    ArticulatedMotion motion = Make(Activity::kGait, seed, 2);
    MakeWild(motion, options, Rng(seed));
    const std::vector<Eigen::Vector3d> p = Positions(motion, 0);
    for (const int side : {kLeft, kRight}) {
      above += p[std::size_t(ArmJoint(kBLElbow, side))].z() > p[std::size_t(ArmJoint(kBLShoulder, side))].z() ? 1 : 0;
    }
  }
  // Each arm takes part in 85 % of the clips.
  EXPECT_GT(above, 65);
  EXPECT_LT(above, 97);
}

TEST(WildMotion, TumbledBodiesAreInvertedAsOftenAsUpright) {
  WildOptions options = Tame();
  options.tumbled = 1.0;
  int inverted = 0;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    ArticulatedMotion motion = Make(Activity::kGait, seed, 2);
    MakeWild(motion, options, Rng(seed));
    const std::vector<Eigen::Vector3d> p = Positions(motion, 0);
    inverted += p[kBThorax].z() < p[kBHip].z() ? 1 : 0;
  }
  EXPECT_GT(inverted, 18);
  EXPECT_LT(inverted, 42);
}

TEST(WildMotion, AMixedBodyHasItsOwnLegsAndTheOthersArms) {
  const ArticulatedMotion own = Make(Activity::kGait, 1);
  const ArticulatedMotion other = Make(Activity::kDance, 2, 15);
  ArticulatedMotion mixed = own;
  TakeUpperBody(other, mixed);
  for (int f = 0; f < mixed.frame_count(); ++f) {
    for (const int joint : {kBHip, kBLHip, kBRHip, kBLKnee, kBRKnee, kBLFoot}) {
      EXPECT_EQ(Local(mixed, f, joint).coeffs(), Local(own, f, joint).coeffs());
    }
    for (const int joint : {kBLumbar, kBSpine, kBNeck, kBLShoulder, kBRShoulder, kBLElbow, kBRElbow}) {
      EXPECT_EQ(Local(mixed, f, joint).coeffs(), Local(other, f % 15, joint).coeffs());
    }
  }
}

}  // namespace
}  // namespace canonpose
