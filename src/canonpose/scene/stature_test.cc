#include "canonpose/scene/stature.h"

#include <cmath>

#include <gtest/gtest.h>

#include "canonpose/scene/world_testing.h"

namespace canonpose {
namespace {

using testing::MakePerson;
using testing::Posture;

TEST(EstimateStature, DoesNotDependOnThePosture) {
  Posture sitting;
  sitting.knees_rad = 1.5;
  sitting.lean_rad = 0.7;
  for (const Posture& posture : {Posture{}, sitting}) {
    const auto stature = EstimateStature(MakePerson({posture, posture}, 1650.0));
    ASSERT_TRUE(stature);
    EXPECT_NEAR(stature->stature, 1650.0, 0.1);
    EXPECT_EQ(stature->bones, "the lengths of legs and trunk");
  }
}

TEST(EstimateStature, IsLessCertainTheFewerBonesAreKnown) {
  PoseSequence person = MakePerson({Posture{}}, 1650.0);
  const double all = EstimateStature(person)->uncertainty_percent;
  const auto forget = [&](const char* joint) {
    person.PoseAt(0).row(*person.skeleton().Find(joint)).setConstant(std::nanf(""));
  };
  forget("LHip");
  const auto right_leg = EstimateStature(person);
  EXPECT_NEAR(right_leg->stature, 1650.0, 0.1);
  EXPECT_EQ(right_leg->bones, "the lengths of the legs");
  EXPECT_GT(right_leg->uncertainty_percent, all);
  forget("RHip");
  forget("LKnee");
  forget("RKnee");
  const auto arms = EstimateStature(person);
  EXPECT_NEAR(arms->stature, 1650.0, 5.0);  // the arms of the test hang a little outwards
  EXPECT_EQ(arms->bones, "the lengths of the arms");
}

TEST(EstimateStature, NeedsAPerson) {
  EXPECT_FALSE(EstimateStature(PoseSequence({"", {"nose", "tail"}, {-1, 0}, 0, {0, 1}}, 3)));
  EXPECT_FALSE(EstimateStature(PoseSequence(*FindSkeleton("h36m-17"), 3)));
}

}  // namespace
}  // namespace canonpose
