#include "canonpose/solve/assignment.h"

#include <algorithm>
#include <limits>
#include <numeric>

#include <gtest/gtest.h>

#include "canonpose/base/random.h"

namespace canonpose {
namespace {

double CostOf(const std::vector<std::vector<double>>& costs, const std::vector<int>& columns, double alone) {
  double sum = 0.0;
  for (std::size_t row = 0; row < costs.size(); ++row) {
    sum += columns[row] < 0 ? alone : costs[row][static_cast<std::size_t>(columns[row])];
  }
  return sum;
}

/// The least cost by trying everything.
double LeastCost(const std::vector<std::vector<double>>& costs, double alone) {
  std::vector<int> places(costs.front().size() + costs.size());
  std::iota(places.begin(), places.end(), 0);
  double least = std::numeric_limits<double>::infinity();
  do {
    std::vector<int> columns;
    for (std::size_t row = 0; row < costs.size(); ++row) {
      columns.push_back(places[row] < static_cast<int>(costs.front().size()) ? places[row] : -1);
    }
    least = std::min(least, CostOf(costs, columns, alone));
  } while (std::ranges::next_permutation(places).found);
  return least;
}

TEST(Assignment, IsTheCheapest) {
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    Rng rng(seed, {1});
    const std::size_t rows = 1 + seed % 4;
    const std::size_t columns = 1 + seed / 4 % 3;
    std::vector<std::vector<double>> costs(rows, std::vector<double>(columns));
    for (std::vector<double>& row : costs) {
      for (double& cost : row) cost = rng.Uniform(-0.5, 1.0);
    }
    const std::vector<int> found = AssignAtLeastCost(costs, 0.4);
    for (std::size_t row = 0; row < rows; ++row) {
      if (found[row] < 0) continue;
      EXPECT_EQ(std::ranges::count(found, found[row]), 1) << seed;
    }
    EXPECT_NEAR(CostOf(costs, found, 0.4), LeastCost(costs, 0.4), 1e-12) << seed;
  }
}

TEST(Assignment, TakesAnythingEmpty) {
  EXPECT_TRUE(AssignAtLeastCost({}, 1.0).empty());
  EXPECT_EQ(AssignAtLeastCost({{}, {}}, 1.0), (std::vector<int>{-1, -1}));
}

}  // namespace
}  // namespace canonpose
