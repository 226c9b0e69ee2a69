#include "canonpose/motion/calm_rotations.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "canonpose/base/random.h"
#include "canonpose/geometry/angles.h"

namespace canonpose {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double kCalm = 6.0;

double LargestStepDegrees(const std::vector<Quaterniond>& rotations) {
  double largest = 0.0;
  for (std::size_t t = 1; t < rotations.size(); ++t)
    largest = std::max(largest, DegFromRad(rotations[t].angularDistance(rotations[t - 1])));
  return largest;
}

Aim AimAt(const Vector3d& direction) {
  Aim aim;
  aim.is_known = true;
  aim.direction = direction.normalized();
  return aim;
}

TEST(CalmRotations, FollowTheDirectionAndTheHint) {
  const Quaterniond truth =
      Eigen::AngleAxisd(0.8, Vector3d(1, 2, -1).normalized()) * Eigen::AngleAxisd(2.5, Vector3d::UnitX());
  Aim aim = AimAt(truth * Vector3d::UnitX());
  aim.hints.push_back({Vector3d::UnitY(), truth * Vector3d::UnitY(), 1000.0});
  const std::vector<Quaterniond> rotations = CalmRotations(Vector3d::UnitX(), {aim, aim, aim}, kCalm);
  ASSERT_EQ(rotations.size(), 3U);
  for (const Quaterniond& rotation : rotations) EXPECT_LT(rotation.angularDistance(truth), 1e-4);
}

// The smallest rotation from rest flips near the opposite direction; carried along from frame to frame it does not.
TEST(CalmRotations, StayCalmNearTheOppositeOfTheRestDirection) {
  std::vector<Aim> aims;
  for (int t = 0; t < 200; ++t) {
    const double turn = 2.0 * 3.14159265 * t / 200.0;
    aims.push_back(AimAt({-1.0, 0.05 * std::cos(turn) + 0.03, 0.05 * std::sin(turn)}));
  }
  const std::vector<Quaterniond> rotations = CalmRotations(Vector3d::UnitX(), aims, kCalm);
  EXPECT_LT(LargestStepDegrees(rotations), 1.0);
  for (std::size_t t = 0; t < aims.size(); ++t)
    EXPECT_LT((rotations[t] * Vector3d::UnitX() - aims[t].direction).norm(), 1e-9);
}

// A limb that is almost straight has a plane that noise turns about; where it bends, the plane counts.
TEST(CalmRotations, WeakHintsOfRandomDirectionAreAveraged) {
  Rng rng(3);
  std::vector<Aim> aims;
  for (int t = 0; t < 300; ++t) {
    Aim aim = AimAt(Vector3d::UnitX());
    const bool bends = t < 50 || t >= 250;
    const double size = bends ? 0.7 : 0.05;
    const double angle = bends ? 0.5 : rng.Uniform(-3.14, 3.14);
    aim.hints.push_back({Vector3d::UnitY(), size * Vector3d(0.0, std::cos(angle), std::sin(angle)), size});
    aims.push_back(aim);
  }
  const std::vector<Quaterniond> rotations = CalmRotations(Vector3d::UnitX(), aims, kCalm);
  EXPECT_LT(LargestStepDegrees(rotations), 3.0);
  for (const int t : {10, 45, 255, 290}) {
    EXPECT_LT(
        rotations[static_cast<std::size_t>(t)].angularDistance(Quaterniond(Eigen::AngleAxisd(0.5, Vector3d::UnitX()))),
        0.1)
        << t;
  }
}

TEST(CalmRotations, UnknownFramesAreInterpolatedAndHeld) {
  std::vector<Aim> aims(11);
  aims[2] = AimAt(Vector3d::UnitX());
  aims[8] = AimAt(Vector3d::UnitY());
  const std::vector<Quaterniond> rotations = CalmRotations(Vector3d::UnitX(), aims, kCalm);
  EXPECT_LT((rotations[0] * Vector3d::UnitX() - Vector3d::UnitX()).norm(), 1e-9);
  EXPECT_LT((rotations[10] * Vector3d::UnitX() - Vector3d::UnitY()).norm(), 1e-9);
  EXPECT_LT((rotations[5] * Vector3d::UnitX() - Vector3d(1, 1, 0).normalized()).norm(), 1e-6);
  for (const Quaterniond& rotation : CalmRotations(Vector3d::UnitZ(), std::vector<Aim>(3), kCalm))
    EXPECT_EQ(rotation.w(), 1.0);
}

}  // namespace
}  // namespace canonpose
