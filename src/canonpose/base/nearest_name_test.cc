#include "canonpose/base/nearest_name.h"

#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace canonpose {
namespace {

TEST(NearestName, FindsSlipsAndBeginningsAndNothingElse) {
  const std::vector<std::string> names = {"import", "train", "train-morph", "evaluate", "lift"};
  EXPECT_EQ(NearestName("imprt", names), "import");
  EXPECT_EQ(NearestName("Import", names), "import");
  EXPECT_EQ(NearestName("trian", names), "train") << "swapped letters are one mistake";
  EXPECT_EQ(NearestName("trains", names), "train");
  EXPECT_EQ(NearestName("train_morph", names), "train-morph");
  EXPECT_EQ(NearestName("eval", names), "evaluate");
  EXPECT_EQ(NearestName("tra", names), std::nullopt) << "a prefix of two names";
  EXPECT_EQ(NearestName("fly", names), std::nullopt);
  EXPECT_EQ(NearestName("", names), std::nullopt);
}

}  // namespace
}  // namespace canonpose
