#include "canonpose/scene/feet.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "canonpose/scene/world_testing.h"

namespace canonpose {
namespace {

using testing::MakePerson;
using testing::Posture;
using testing::Walk;

constexpr double kStatureMm = 1800.0;

TEST(Feet, StandStillBetweenSteps) {
  const PoseSequence person = MakePerson(Walk(), kStatureMm);
  const Feet feet(person, kStatureMm);
  ASSERT_TRUE(feet.any());
  EXPECT_TRUE(feet.only_ankles());
  const std::vector<Stance> stances = feet.Stances(Eigen::Vector3d::UnitZ());
  ASSERT_EQ(stances.size(), 10U);  // five places, two feet
  for (const Stance& stance : stances) {
    EXPECT_NEAR(stance.position.z(), kAnkleHeight * kStatureMm, 0.01);
    EXPECT_NEAR(stance.height, kAnkleHeight * kStatureMm, 1e-9);
    EXPECT_GE(stance.last_frame - stance.first_frame, 24);
    EXPECT_LE(stance.last_frame - stance.first_frame, 29);
  }
}

TEST(Feet, AMissingFootStandsNowhere) {
  PoseSequence person = MakePerson(std::vector<Posture>(60), kStatureMm);
  const int left = *person.skeleton().Find("LFoot");
  for (int t = 10; t < 60; ++t) person.PoseAt(t).row(left).setConstant(std::nanf(""));
  const std::vector<Stance> stances = Feet(person, kStatureMm).Stances(Eigen::Vector3d::UnitZ());
  ASSERT_EQ(stances.size(), 2U);
  EXPECT_LT(stances[0].last_frame, 10);
  EXPECT_EQ(stances[1].last_frame, 59);
  for (int t = 0; t < 60; ++t) {
    for (const char* joint : {"LFoot", "RFoot"}) {
      person.PoseAt(t).row(*person.skeleton().Find(joint)).setConstant(std::nanf(""));
    }
  }
  EXPECT_TRUE(std::isnan(Feet(person, kStatureMm).LowestSole(0, Eigen::Vector3d::UnitZ())));
}

TEST(Feet, HeelsAndToesAreNearerToTheFloor) {
  PoseSequence person(*FindSkeleton("body_25"), 30);
  person.fps = 30.0;
  for (int t = 0; t < 30; ++t) {
    person.PoseAt(t).row(*person.skeleton().Find("LHeel")) = Eigen::RowVector3f(0, 0, 20);
    person.PoseAt(t).row(*person.skeleton().Find("LAnkle")) = Eigen::RowVector3f(0, 0, 80);
  }
  const Feet feet(person, kStatureMm);
  EXPECT_FALSE(feet.only_ankles());
  EXPECT_NEAR(feet.LowestSole(3, Eigen::Vector3d::UnitZ()), 20.0 - kHeelHeight * kStatureMm, 1e-3);
}

}  // namespace
}  // namespace canonpose
