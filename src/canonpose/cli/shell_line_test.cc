#include "canonpose/cli/shell_line.h"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace canonpose {
namespace {

TEST(ShellLine, SpellsFieldsAsOptions) {
  const ResolvedCommand command{
      "solve", {"data.h5"}, {{"output", "solved.h5"}, {"camera_distance", "a,b=4.2"}, {"calibrated_scale", ""}}};
  EXPECT_EQ(ShellLine(CommandLineOf(command)),
            "solve data.h5 -o solved.h5 --camera-distance a,b=4.2 --calibrated-scale");
}

TEST(ShellLine, QuotesWhatAShellWouldRead) {
  EXPECT_EQ(ShellLine({"view", "my take.h5", "it's", "a$b", "cam*/x", ""}),
            "view 'my take.h5' 'it'\\''s' 'a$b' 'cam*/x' ''");
}

}  // namespace
}  // namespace canonpose
