#include "canonpose/detect/tracker.h"

#include <map>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/base/testing.h"
#include "canonpose/detect/detect_testing.h"

namespace canonpose {
namespace {

using ::testing::HasSubstr;
using ::testing::SizeIs;
using testing::Walker;
using testing::WalkerNetwork;

constexpr Appearance kRed{0.8F, 0.2F, 0.2F, 0.3F, 0.3F, 0.3F};
constexpr Appearance kBlue{0.2F, 0.2F, 0.8F, 0.1F, 0.1F, 0.3F};

Walker Walk(float from, float step, const Appearance& appearance) {
  Walker walker;
  walker.x = [=](long frame) { return from + step * static_cast<float>(frame); };
  walker.appearance = appearance;
  return walker;
}

/// Per walker, the ids under which it was seen, after checking that every pose is a walker's.
struct Identities {
  std::map<std::size_t, std::set<int>> ids;
  std::map<std::size_t, int> frames;
};

Identities Track(WalkerNetwork& network, std::size_t walkers, int frames) {
  PersonTracker tracker(network, 1280, 720);
  Identities seen;
  for (network.frame = 0; network.frame < frames; ++network.frame) {
    for (const TrackedPose& person : tracker.Next({})) {
      std::size_t best = 0;
      for (std::size_t w = 1; w < walkers; ++w) {
        if (PoseDistance(person.pose, network.PoseOf(w)) < PoseDistance(person.pose, network.PoseOf(best))) best = w;
      }
      EXPECT_LT(PoseDistance(person.pose, network.PoseOf(best)), 1e-3) << "frame " << network.frame;
      seen.ids[best].insert(person.id);
      ++seen.frames[best];
    }
  }
  return seen;
}

TEST(PersonTracker, FollowsOnePersonInACropAndSearchesNowAndThen) {
  WalkerNetwork network({Walk(200.0F, 4.0F, kRed)});
  const Identities seen = Track(network, 1, 150);
  EXPECT_THAT(seen.ids.at(0), SizeIs(1));
  EXPECT_EQ(seen.frames.at(0), 150);
  EXPECT_EQ(network.searches, 10);
  EXPECT_LT(network.crops, 155);
}

TEST(PersonTracker, KeepsIdsWherePeopleCross) {
  for (const float speed : {2.0F, 4.0F, 8.0F}) {
    const int frames = static_cast<int>(800.0F / speed);
    Walker in_front = Walk(1000.0F, -speed, kBlue);
    in_front.y = 312.0F;
    in_front.trunk = 66.0F;
    WalkerNetwork network({Walk(200.0F, speed, kRed), in_front});
    const Identities seen = Track(network, 2, frames);
    EXPECT_THAT(seen.ids.at(0), SizeIs(1)) << speed;
    EXPECT_THAT(seen.ids.at(1), SizeIs(1)) << speed;
    EXPECT_NE(seen.ids.at(0), seen.ids.at(1));
    EXPECT_EQ(seen.frames.at(1), frames) << "the one in front is always seen";
    EXPECT_GE(seen.frames.at(0), frames - 2 * static_cast<int>(24.0F / speed) - 8)
        << "the other is hidden for a moment";
  }
}

TEST(PersonTracker, FindsWhoLeftAndReturnsByColours) {
  Walker away = Walk(300.0F, 1.0F, kRed);
  away.is_visible = [](long frame) { return frame < 40 || frame >= 240; };
  away.x = [](long frame) { return frame < 100 ? 300.0F : 1100.0F; };
  Walker stays = Walk(700.0F, 0.0F, kBlue);
  WalkerNetwork network({away, stays});
  const Identities seen = Track(network, 2, 300);
  EXPECT_THAT(seen.ids.at(0), SizeIs(1));
  EXPECT_GE(seen.frames.at(0), 40 + 60 - 15);
  EXPECT_THAT(seen.ids.at(1), SizeIs(1));
}

TEST(PersonTracker, GivesSomebodyElseANewId) {
  Walker first = Walk(300.0F, 0.0F, kRed);
  first.is_visible = [](long frame) { return frame < 50; };
  Walker ghost = Walk(600.0F, 0.0F, kBlue);
  ghost.is_visible = [](long frame) { return frame == 15; };  // when the whole image is searched
  Walker second = Walk(900.0F, 0.0F, kBlue);
  second.is_visible = [](long frame) { return frame >= 60; };
  WalkerNetwork network({first, ghost, second});
  const Identities seen = Track(network, 3, 120);
  EXPECT_EQ(seen.frames.at(1), 1) << "the ghost is seen, and forgotten when lost";
  std::set<int> all;
  std::size_t count = 0;
  for (const auto& [walker, ids] : seen.ids) {
    all.insert(ids.begin(), ids.end());
    count += ids.size();
  }
  EXPECT_EQ(all.size(), count) << "two walkers have one id";
  EXPECT_THAT(seen.ids.at(2), SizeIs(1));
}

TEST(PersonTracker, FollowsNoMorePeopleThanAllowed) {
  WalkerNetwork network({Walk(200.0F, 0.0F, kRed), Walk(600.0F, 0.0F, kBlue), Walk(1000.0F, 0.0F, kRed)});
  PersonTracker tracker(network, 1280, 720, {.search_interval = 1, .most_people = 2});
  for (network.frame = 0; network.frame < 5; ++network.frame) EXPECT_THAT(tracker.Next({}), SizeIs(2));
}

TEST(PersonTracker, RefusesSenselessOptions) {
  WalkerNetwork network({});
  EXPECT_THAT(
      testing::ErrorOf(ErrorKind::kInvalidArgument, [&] { PersonTracker(network, 640, 480, {.search_interval = 0}); }),
      HasSubstr("`search_interval`"));
  EXPECT_THAT(testing::ErrorOf(ErrorKind::kInvalidArgument,
                               [&] { PersonTracker(network, 640, 480, {.search_interval = 1, .most_people = 0}); }),
              HasSubstr("`most_people`"));
}

}  // namespace
}  // namespace canonpose
