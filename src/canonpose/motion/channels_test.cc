#include "canonpose/motion/channels.h"

#include <numbers>

#include <gtest/gtest.h>

namespace canonpose {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

TEST(ZUpFromYUp, TurnsUpToUpAndComesBack) {
  EXPECT_EQ(ZUpFromYUp(Vector3d::UnitY()), Vector3d::UnitZ());
  EXPECT_EQ(ZUpFromYUp(Vector3d::UnitX()), Vector3d::UnitX());
  const Vector3d v(1.0, 2.0, 3.0);
  EXPECT_EQ(YUpFromZUp(ZUpFromYUp(v)), v);
}

TEST(ZUpFromYUp, ConvertsRotationsConsistently) {
  const Quaterniond q = Quaterniond(0.4, -0.3, 0.7, 0.5).normalized();
  const Vector3d v(1.0, 2.0, 3.0);
  EXPECT_LT((ZUpFromYUp(q) * ZUpFromYUp(v) - ZUpFromYUp(Vector3d(q * v))).norm(), 1e-12);
  EXPECT_EQ(YUpFromZUp(ZUpFromYUp(q)).coeffs(), q.coeffs());
}

TEST(RotationAbout, IsRightHanded) {
  EXPECT_LT((RotationAbout(2, std::numbers::pi / 2.0) * Vector3d::UnitX() - Vector3d::UnitY()).norm(), 1e-12);
  EXPECT_LT((RotationAbout(0, std::numbers::pi / 2.0) * Vector3d::UnitY() - Vector3d::UnitZ()).norm(), 1e-12);
}

}  // namespace
}  // namespace canonpose
