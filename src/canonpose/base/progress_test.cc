#include "canonpose/base/progress.h"

#include <gtest/gtest.h>

namespace canonpose {
namespace {

TEST(FormatDuration, ChoosesTheUnit) {
  EXPECT_EQ(FormatDuration(12.4), "12 s");
  EXPECT_EQ(FormatDuration(185), "3 min 05 s");
  EXPECT_EQ(FormatDuration(3720), "1 h 02 min");
}

}  // namespace
}  // namespace canonpose
