#include "canonpose/pipeline/run_options.h"

#include <set>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/base/testing.h"

namespace canonpose {
namespace {

using ::testing::ElementsAre;
using testing::TemporaryFolder;

std::vector<std::string> FieldsOf(const StepCommand& command) {
  std::vector<std::string> fields;
  for (const auto& [field, value] : command.fields) fields.push_back(field + "=" + value.text);
  return fields;
}

TEST(RunOptions, TableHasEachRowOnce) {
  std::set<std::string> rows;
  for (const RunOption& option : RunOptionTable()) {
    EXPECT_TRUE(rows.insert(std::string(option.command) + " " + std::string(option.field)).second) << option.field;
  }
}

TEST(RunOptions, EachCommandGetsItsOwnInTheOrderGiven) {
  RunOptions options;
  options.fields = {
      {"fps", "50"}, {"threads", "2"}, {"image_size", "a=10x20"}, {"image_size", "30x40"}, {"moving", ""}};
  const RecordingInputs keypoints{false, false, "openpose", {}};
  StepCommand import{"import", {}, {}};
  AddFields(options, keypoints, import);
  EXPECT_THAT(FieldsOf(import), ElementsAre("fps=50", "image_size=a=10x20", "image_size=30x40", "moving="));
  StepCommand solve{"solve", {}, {}};
  AddFields(options, keypoints, solve);
  EXPECT_THAT(FieldsOf(solve), ElementsAre("threads=2"));
  const RecordingInputs images{true, true, "", {}};
  StepCommand detect{"detect", {}, {}};
  AddFields(options, images, detect);
  EXPECT_THAT(FieldsOf(detect), ElementsAre("fps=50", "threads=2"));
}

TEST(RunOptions, AValueThatMayBeAPathIsOneWhereItIsThere) {
  const TemporaryFolder folder;
  RunOptions options;
  options.fields = {{"layout", "coco-17"}, {"layout", folder.path().string()}, {"name", folder.path().string()}};
  StepCommand import{"import", {}, {}};
  AddFields(options, {false, false, "openpose", {}}, import);
  ASSERT_EQ(import.fields.size(), 3U);
  EXPECT_EQ(import.fields[0].second.kind, StepValue::Kind::kText);
  EXPECT_EQ(import.fields[1].second.kind, StepValue::Kind::kInput);
  EXPECT_EQ(import.fields[2].second.kind, StepValue::Kind::kText);
}

}  // namespace
}  // namespace canonpose
