#include "canonpose/base/parallel.h"

#include <atomic>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace canonpose {
namespace {

TEST(InParallel, DoesEachPieceOnce) {
  for (const int threads : {1, 2, 5}) {
    std::vector<std::atomic<int>> done(50);
    InParallel(50, threads, [&](int i) { ++done[static_cast<std::size_t>(i)]; });
    for (const std::atomic<int>& count : done) EXPECT_EQ(count, 1) << threads;
  }
  InParallel(0, 2, [](int) { FAIL(); });
}

TEST(InParallel, ThrowsWhatTheFirstFailedPieceThrew) {
  for (const int threads : {1, 3}) {
    try {
      InParallel(20, threads, [](int i) {
        if (i == 4 || i == 17) throw std::runtime_error(std::to_string(i));
      });
      FAIL();
    } catch (const std::runtime_error& error) {
      EXPECT_STREQ(error.what(), "4");
    }
  }
}

}  // namespace
}  // namespace canonpose
