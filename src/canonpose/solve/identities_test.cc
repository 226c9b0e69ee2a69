#include "canonpose/solve/identities.h"

#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/base/testing.h"
#include "canonpose/solve/people_testing.h"

namespace canonpose {
namespace {

using testing::CountRight;
using testing::Crowd;
using testing::ErrorOf;
using testing::IdentityCount;
using testing::MakeCrowd;
using testing::SmallCrowd;
using testing::StartOfLanes;

PeopleObservations Observe(const Crowd& crowd) {
  Lanes lanes = MakeLanes(crowd.apart.skeleton, crowd.together);
  const StartPoses start = StartOfLanes(crowd, lanes);
  return CollectPeople(std::move(lanes), start);
}

TEST(Identities, ThreePeopleWhoseTracksAreBrokenAndExchanged) {
  const Crowd crowd = MakeCrowd(SmallCrowd(3));
  const PeopleObservations people = Observe(crowd);
  const FoundPeople found = FindPeople(people, {});
  ASSERT_EQ(found.people.size(), 3U);
  EXPECT_GT(found.explained, 0.9);
  for (const FoundPerson& person : found.people) {
    const IdentityCount count = CountRight(crowd, people.lanes, person.person);
    EXPECT_GT(count.poses, 0.95 * people.lanes.frame_count);
    EXPECT_GE(count.right, 0.98 * count.poses);
    EXPECT_EQ(person.frames, count.poses);
    EXPECT_LT(person.error, 0.01);
    EXPECT_GT(person.sure, 0.8);
  }
}

TEST(Identities, DoNotDependOnThreads) {
  CANONPOSE_SKIP_UNDER_SANITIZERS();
  const Crowd crowd = MakeCrowd(SmallCrowd(2));
  const PeopleObservations people = Observe(crowd);
  const FoundPeople one = FindPeople(people, {.threads = 1});
  const FoundPeople two = FindPeople(people, {.threads = 2});
  ASSERT_EQ(one.people.size(), two.people.size());
  for (std::size_t p = 0; p < one.people.size(); ++p) {
    EXPECT_EQ(one.people[p].person.lanes, two.people[p].person.lanes);
    EXPECT_EQ(one.people[p].error, two.people[p].error);
  }
}

TEST(Identities, CamerasThatShowOtherPeopleHaveNobodyInCommon) {
  Crowd crowd = MakeCrowd(SmallCrowd(2));
  // Each camera sees the hall at another time, and nobody twice.
  SimulationOptions other = SmallCrowd(2);
  for (std::size_t v = 1; v < crowd.together.cameras.size(); ++v) {
    other.seed = 20 + v;
    const Crowd another = MakeCrowd(other);
    crowd.together.cameras[v] = another.together.cameras[v];
    crowd.who[v] = another.who[v];
    for (std::size_t p = 0; p < 2; ++p) crowd.apart.sequences[p].cameras[v] = another.apart.sequences[p].cameras[v];
  }
  const PeopleObservations people = Observe(crowd);
  EXPECT_THAT(ErrorOf(ErrorKind::kComputation, [&] { FindPeople(people, {}); }),
              ::testing::HasSubstr("show people in common"));
}

}  // namespace
}  // namespace canonpose
