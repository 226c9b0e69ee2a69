#include "canonpose/base/hash.h"

#include <gtest/gtest.h>

namespace canonpose {
namespace {

TEST(Fingerprint, MatchesThePublishedVectors) {
  Fingerprint empty;
  EXPECT_EQ(empty.value(), 0xCBF29CE484222325ULL);
  Fingerprint foobar;
  foobar.Add("foobar", 6);
  EXPECT_EQ(foobar.value(), 0x85944171F73967E8ULL);
}

}  // namespace
}  // namespace canonpose
