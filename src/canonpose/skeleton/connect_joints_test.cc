#include "canonpose/skeleton/connect_joints.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace canonpose {
namespace {

using ::testing::ElementsAre;

/// (J, J) distances of points in a plane.
std::vector<double> Distances(const std::vector<std::array<double, 2>>& points) {
  std::vector<double> distances;
  for (const auto& a : points) {
    for (const auto& b : points) distances.push_back(std::hypot(a[0] - b[0], a[1] - b[1]));
  }
  return distances;
}

std::string ParentOf(const Skeleton& skeleton, const char* joint) {
  const int parent = skeleton.parents[static_cast<std::size_t>(skeleton.Find(joint).value())];
  return parent < 0 ? "" : skeleton.joints[static_cast<std::size_t>(parent)];
}

// A mouse from above: the ears are closer to each other than to the neck.
TEST(ConnectJoints, ByTheShortestTreeThatIsTheSameOnBothSides) {
  const Skeleton mouse =
      ConnectJoints("mouse", {"left ear", "right ear", "nose", "neck", "spine", "tail"}, {},
                    Distances({{-1.0, 2.0}, {1.0, 2.0}, {0.0, 4.0}, {0.0, 0.1}, {0.0, -3.0}, {0.0, -6.0}}));
  EXPECT_EQ(mouse.Problem(), "");
  EXPECT_THAT(mouse.mirror, ElementsAre(1, 0, 2, 3, 4, 5));
  EXPECT_EQ(ParentOf(mouse, "left ear"), "neck");
  EXPECT_EQ(ParentOf(mouse, "right ear"), "neck");
  EXPECT_EQ(ParentOf(mouse, "tail"), "spine");
  EXPECT_EQ(mouse.joints[static_cast<std::size_t>(mouse.root)], "neck") << "in the middle";
}

TEST(ConnectJoints, BonesOfTheFileComeFirst) {
  const std::vector<double> distances = Distances({{0, 0}, {1, 0}, {2, 0}, {3, 0}});
  const Skeleton all = ConnectJoints("", {"a", "b", "c", "d"}, {{2, 0}, {2, 1}, {1, 3}}, distances);
  EXPECT_THAT(all.parents, ElementsAre(2, 2, -1, 1));
  EXPECT_EQ(all.root, 2) << "which is nowhere the second of a pair";
  const Skeleton some = ConnectJoints("", {"a", "b", "c", "d"}, {{0, 3}}, distances);
  EXPECT_EQ(some.Problem(), "");
  EXPECT_TRUE(ParentOf(some, "d") == "a" || ParentOf(some, "a") == "d");
}

TEST(ConnectJoints, CirclesAndUnknownDistancesDoNoHarm) {
  const Skeleton circle = ConnectJoints("", {"a", "b", "c"}, {{0, 1}, {1, 2}, {2, 0}}, {});
  EXPECT_EQ(circle.Problem(), "");
  std::vector<double> distances = Distances({{0, 0}, {1, 0}, {2, 0}});
  for (const int i : {0 * 3 + 1, 1 * 3 + 0}) distances[static_cast<std::size_t>(i)] = NAN;
  const Skeleton part = ConnectJoints("", {"a", "b", "c"}, {}, distances);
  EXPECT_EQ(part.Problem(), "");
  EXPECT_EQ(part.joints[static_cast<std::size_t>(part.root)], "c") << "a and b are never seen together";
  EXPECT_EQ(ConnectJoints("", {"one"}, {}, {}).Problem(), "");
}

TEST(ConnectJoints, ThePelvisIsTheRoot) {
  const Skeleton person = ConnectJoints("", {"head", "neck", "pelvis"}, {}, Distances({{0, 0}, {1, 0}, {2, 0}}));
  EXPECT_EQ(person.root, 2);
  EXPECT_THAT(person.parents, ElementsAre(1, 2, -1));
}

}  // namespace
}  // namespace canonpose
