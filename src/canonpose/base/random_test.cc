#include "canonpose/base/random.h"

#include <algorithm>
#include <set>
#include <vector>

#include <gtest/gtest.h>

namespace canonpose {
namespace {

TEST(Rng, SameSeedSameNumbersAndStreamsDiffer) {
  Rng a(7, {1, 2});
  Rng b(7, {1, 2});
  Rng c(7, {2, 1});
  EXPECT_EQ(a.Bits(), b.Bits());
  EXPECT_NE(a.Bits(), c.Bits());
}

TEST(Rng, IsTheSameOnEveryMachine) {
  // The first values of seed 1; a change here changes every published result.
  Rng rng(1);
  const double first = rng.Uniform();
  const double second = rng.Uniform();
  Rng again(1);
  EXPECT_EQ(first, again.Uniform());
  EXPECT_EQ(second, again.Uniform());
  EXPECT_NE(first, second);
}

TEST(Rng, NormalHasUnitMomentsAndUniformStaysInRange) {
  Rng rng(3);
  double sum = 0.0;
  double squares = 0.0;
  constexpr int kCount = 100000;
  for (int i = 0; i < kCount; ++i) {
    const double x = rng.Normal();
    sum += x;
    squares += x * x;
    const double u = rng.Uniform(2.0, 3.0);
    ASSERT_GE(u, 2.0);
    ASSERT_LT(u, 3.0);
  }
  EXPECT_NEAR(sum / kCount, 0.0, 0.02);
  EXPECT_NEAR(squares / kCount, 1.0, 0.03);
}

TEST(Rng, PermutationHoldsEachIndexOnceAndEveryOrderOccurs) {
  std::set<std::vector<std::size_t>> seen;
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    std::vector<std::size_t> order = Rng(seed).Permutation(3);
    seen.insert(order);
    std::sort(order.begin(), order.end());
    EXPECT_EQ(order, (std::vector<std::size_t>{0, 1, 2}));
  }
  EXPECT_EQ(seen.size(), 6U);
}

}  // namespace
}  // namespace canonpose
