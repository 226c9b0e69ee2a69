#include "canonpose/base/names.h"

#include <gtest/gtest.h>

namespace canonpose {
namespace {

TEST(Names, CaseIsIgnored) {
  EXPECT_EQ(LowerCase("LHip 2"), "lhip 2");
  EXPECT_TRUE(SameName("LHip", "lhip"));
  EXPECT_FALSE(SameName("LHip", "LHi"));
  EXPECT_FALSE(SameName("LHip", "RHip"));
}

TEST(Names, AreJoinedToASentence) {
  EXPECT_EQ(JoinWithAnd({}), "");
  EXPECT_EQ(JoinWithAnd({"a"}), "a");
  EXPECT_EQ(JoinWithAnd({"a", "b"}), "a and b");
  EXPECT_EQ(JoinWithAnd({"a", "b", "c"}), "a, b and c");
}

}  // namespace
}  // namespace canonpose
