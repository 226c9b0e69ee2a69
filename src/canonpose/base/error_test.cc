#include "canonpose/base/error.h"

#include <gtest/gtest.h>

namespace canonpose {
namespace {

TEST(Error, BadInputIsOneLineWithAllParts) {
  EXPECT_EQ(FormatBadInput({"a.json", "people[0]", "75 values", "74", "export it again"}),
            "a.json: people[0]: expected 75 values, found 74; export it again");
  EXPECT_EQ(FormatBadInput({"a.json", "", "a folder", "nothing\nat all", ""}),
            "a.json: expected a folder, found nothing at all");
  EXPECT_EQ(FormatBadInput({"a.json", "", "", "", "check the path"}), "a.json; check the path");
}

}  // namespace
}  // namespace canonpose
