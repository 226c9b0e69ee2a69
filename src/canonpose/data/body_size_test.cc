#include "canonpose/data/body_size.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "canonpose/skeleton/skeleton.h"

namespace canonpose {
namespace {

/// A person of 1750 mm who stands upright, by h36m-17.
std::vector<float> Standing() {
  const Skeleton& skeleton = *FindSkeleton("h36m-17");
  std::vector<float> pose(3 * skeleton.joints.size(), 0.0F);
  const auto put = [&](const char* joint, float x, float y) {
    const auto j = static_cast<std::size_t>(skeleton.Find(joint).value());
    pose[3 * j] = x;
    pose[3 * j + 1] = y;
    pose[3 * j + 2] = 4000.0F;
  };
  for (const auto& [side, x] : {std::pair("L", 100.0F), std::pair("R", -100.0F)}) {
    const std::string name = side;
    put((name + "Hip").c_str(), x, 0.0F);
    put((name + "Knee").c_str(), x, 429.0F);
    put((name + "Foot").c_str(), x, 859.0F);
    put((name + "Shoulder").c_str(), x, -504.0F);
    put((name + "Elbow").c_str(), x, -178.0F);
    put((name + "Wrist").c_str(), x, 78.0F);
  }
  return pose;
}

TEST(BodySize, IsThatOfThePersonInWhateverUnit) {
  const std::vector<float> pose = Standing();
  for (const double scale : {1.0, 0.1, 0.001}) {
    std::vector<float> scaled = pose;
    for (float& value : scaled) value = static_cast<float>(value * scale);
    BodySize size(*FindSkeleton("h36m-17"));
    size.Add(scaled);
    EXPECT_NEAR(size.Stature().value() / scale, 1750.0, 20.0);
  }
}

TEST(BodySize, NeedsOnlySomeOfTheJoints) {
  std::vector<float> pose = Standing();
  const Skeleton& skeleton = *FindSkeleton("h36m-17");
  for (const char* joint : {"LKnee", "RKnee", "LFoot", "RFoot", "LWrist"}) {
    pose[3 * static_cast<std::size_t>(skeleton.Find(joint).value())] = NAN;
  }
  BodySize size(skeleton);
  size.Add(pose);
  EXPECT_NEAR(size.Stature().value(), 1750.0, 20.0);
}

TEST(BodySize, IsUnknownForBodiesThatAreNotPeople) {
  BodySize size({"", {"tip", "middle", "wing"}, {-1, 0, 1}, 0, {0, 1, 2}});
  size.Add({0, 0, 0, 1, 2, 3, 4, 5, 6});
  EXPECT_FALSE(size.Stature().has_value());
}

TEST(UnitOfStature, IsTheOneThatMakesAPerson) {
  EXPECT_EQ(UnitOfStature(1750.0)->name, "millimetres");
  EXPECT_EQ(UnitOfStature(175.0)->name, "centimetres");
  EXPECT_EQ(UnitOfStature(0.98)->name, "metres");
  EXPECT_EQ(UnitOfStature(1.75)->mm, 1000.0);
  EXPECT_FALSE(UnitOfStature(17.0).has_value());
  EXPECT_FALSE(UnitOfStature(17500.0).has_value());
  EXPECT_EQ(DescribeLength(1.72), "1.72 mm");
  EXPECT_EQ(DescribeLength(17234.0), "17.2 m");
}

}  // namespace
}  // namespace canonpose
