#include "canonpose/detect/covered_joints.h"

#include <gtest/gtest.h>

#include "canonpose/detect/detect_testing.h"

namespace canonpose {
namespace {

using testing::StandingPerson;

TEST(CoveredJoints, LowersScoresOfJointsBehindAnotherTrunk) {
  // The second stands nearer: lower feet, larger. The first's trunk is behind the second's.
  std::vector<TrackedPose> people{{0, StandingPerson(300, 280, 60)}, {1, StandingPerson(305, 330, 80)}};
  people[0].pose.joints[kLHip].position = {300, 300};
  MarkCoveredJoints(people);
  EXPECT_FLOAT_EQ(people[0].pose.joints[kLHip].score, 0.8F * kCoveredShare);
  EXPECT_FLOAT_EQ(people[0].pose.joints[kNose].score, 0.8F) << "above the other's shoulders";
  for (const PosePoint& point : people[1].pose.joints) EXPECT_FLOAT_EQ(point.score, 0.8F);
}

TEST(CoveredJoints, BelievesScoresRatherThanFeet) {
  std::vector<TrackedPose> people{{0, StandingPerson(300, 280, 60)}, {1, StandingPerson(305, 330, 80)}};
  for (PosePoint& point : people[1].pose.joints) point.score = 0.4F;
  const float before = people[0].pose.joints[kLHip].score;
  MarkCoveredJoints(people);
  EXPECT_FLOAT_EQ(people[0].pose.joints[kLHip].score, before);
}

TEST(CoveredJoints, LeavesPeopleApartAlone) {
  std::vector<TrackedPose> people{{0, StandingPerson(300, 300, 60)}, {1, StandingPerson(500, 320, 60)}};
  MarkCoveredJoints(people);
  for (const TrackedPose& person : people) {
    for (const PosePoint& point : person.pose.joints) EXPECT_FLOAT_EQ(point.score, 0.8F);
  }
}

TEST(CoveredJoints, NeedsATrunkThatIsSeen) {
  std::vector<TrackedPose> people{{0, StandingPerson(300, 280, 60)}, {1, StandingPerson(305, 330, 80)}};
  people[1].pose.joints[kRHip].score = 0.0F;
  MarkCoveredJoints(people);
  for (const PosePoint& point : people[0].pose.joints) EXPECT_FLOAT_EQ(point.score, 0.8F);
}

}  // namespace
}  // namespace canonpose
