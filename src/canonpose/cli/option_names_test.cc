#include "canonpose/cli/option_names.h"

#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace canonpose {
namespace {

/// `message` as shown to a user who ran `command`.
std::string Spelled(const std::string& message, const std::string& command) {
  CLI::App app;
  app.add_subcommand("solve")->add_flag("--image-size");
  CLI::App* train = app.add_subcommand("train");
  train->add_flag("--mirror");
  train->add_flag("--epochs");
  app.add_subcommand("train-morph")->add_flag("--learning-rate");
  app.parse(std::vector<std::string>{command});
  return SpellOptions(message, app, [](const std::string& name) { return name == "learning_rate" || name == "ray"; });
}

TEST(SpellOptions, TakesTheOptionOfTheCommandGiven) {
  EXPECT_EQ(Spelled("give `image_size` WxH", "solve"), "give --image-size WxH");
  EXPECT_EQ(Spelled("a smaller `learning_rate`", "train-morph"), "a smaller --learning-rate");
  EXPECT_EQ(Spelled("`epochs=3` and `mirror`", "train"), "--epochs 3 and --mirror");
}

TEST(SpellOptions, OtherwiseTakesTheTrainingOptionOrThatOfAnotherCommand) {
  EXPECT_EQ(Spelled("a smaller `learning_rate`", "train"), "a smaller --set learning_rate");
  EXPECT_EQ(Spelled("with `ray=off` or `mirror` flip", "solve"), "with --set ray=off or --mirror flip");
  EXPECT_EQ(Spelled("import with `image_size`", "train"), "import with --image-size");
}

TEST(SpellOptions, LeavesOtherWordsAlone) {
  EXPECT_EQ(Spelled("run `canonpose solve` first", "train"), "run `canonpose solve` first");
  EXPECT_EQ(Spelled("an odd ` stays", "train"), "an odd ` stays");
  EXPECT_EQ(Spelled("``", "train"), "``");
  EXPECT_EQ(Spelled("", "train"), "");
}

}  // namespace
}  // namespace canonpose
