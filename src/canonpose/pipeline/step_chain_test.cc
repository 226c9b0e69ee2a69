#include "canonpose/pipeline/step_chain.h"

#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/base/atomic_file.h"
#include "canonpose/base/testing.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::ElementsAre;
using testing::ErrorOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::TemporaryFolder;

void Write(const fs::path& path, const std::string& text) {
  fs::create_directories(path.parent_path());
  std::ofstream(path, std::ios::binary) << text;
}

std::string Spell(const ResolvedCommand& command) {
  std::string line = fmt::format("{} {}", command.name, fmt::join(command.arguments, " "));
  for (const auto& [field, value] : command.fields) line += fmt::format(" {}={}", field, value);
  return line;
}

/// A program whose command `join` writes its inputs and its option `mark` one after the other.
class Joiner {
 public:
  explicit Joiner(fs::path folder) : folder_(std::move(folder)) {}

  /// Executes steps in a new chain, as a new process does; returns the commands that were executed.
  std::vector<std::string> Do(const std::vector<Step>& steps) {
    executed_.clear();
    StepChain chain(folder_, {[this](const ResolvedCommand& command) { Execute(command); }, {}, Spell});
    for (const Step& step : steps) chain.Do(step);
    outputs_of_last_ = chain.OutputsOf(steps.back().name);
    return executed_;
  }

  std::optional<Error> error;           ///< thrown by the next command
  std::vector<std::string> also_write;  ///< more files, below the folder
  std::vector<std::string> outputs_of_last_;

 private:
  void Execute(const ResolvedCommand& command) {
    std::string text;
    fs::path output;
    executed_.push_back(command.name);
    for (const std::string& input : command.arguments) text += ReadFile(input);
    for (const auto& [field, value] : command.fields) {
      if (field == "mark") text += value;
      if (field == "output") output = value;
      if (field == "resume" || field == "overwrite") executed_.back() += " " + field;
    }
    if (error) {
      const Error thrown = *error;
      error.reset();
      throw thrown;
    }
    WriteFileAtomically(output, text);
    for (const std::string& path : also_write) Write(folder_ / path, text);
  }

  fs::path folder_;
  std::vector<std::string> executed_;
};

Step Join(const std::string& name, const std::vector<StepValue>& inputs, const std::string& mark) {
  Step step{name, "Making " + name, {name, inputs, {{"output", StepValue::Output(name + ".txt")}}}, {name + ".txt"}};
  step.command.fields.emplace_back("mark", StepValue::Text(mark));
  return step;
}

/// A chain of two steps on the user's file.
std::vector<Step> Chain(const fs::path& input, const std::string& first_mark = "1", const std::string& mark = "2") {
  return {Join("first", {StepValue::Input(input.string())}, first_mark),
          Join("second", {StepValue::Result("first.txt")}, mark)};
}

class StepChainTest : public ::testing::Test {
 protected:
  void SetUp() override { Write(input_, "input"); }

  TemporaryFolder folder_;
  fs::path input_ = folder_ / "input";
  fs::path output_ = folder_ / "out";
  Joiner joiner_{output_};
};

TEST_F(StepChainTest, LeavesAloneWhatIsDone) {
  fs::create_directories(output_);
  EXPECT_THAT(joiner_.Do(Chain(input_)), ElementsAre("first", "second"));
  EXPECT_EQ(ReadFile(output_ / "second.txt"), "input12");
  EXPECT_THAT(joiner_.Do(Chain(input_)), IsEmpty());
}

TEST_F(StepChainTest, DoesAgainWhatFollowsFromAChange) {
  fs::create_directories(output_);
  joiner_.Do(Chain(input_));
  EXPECT_THAT(joiner_.Do(Chain(input_, "1", "3")), ElementsAre("second"));
  EXPECT_THAT(joiner_.Do(Chain(input_, "4", "3")), ElementsAre("first", "second"));
  Write(input_, "other");
  EXPECT_THAT(joiner_.Do(Chain(input_, "4", "3")), ElementsAre("first", "second"));
  EXPECT_EQ(ReadFile(output_ / "second.txt"), "other43");
}

TEST_F(StepChainTest, StopsDoingAgainWhereTheResultIsTheSame) {
  fs::create_directories(output_);
  joiner_.Do(Chain(input_, "1"));
  Write(input_, "inpu");
  EXPECT_THAT(joiner_.Do(Chain(input_, "t1")), ElementsAre("first"));
}

TEST_F(StepChainTest, TimesAndPlacesDoNotCount) {
  fs::create_directories(output_);
  joiner_.Do(Chain(input_));
  Write(input_, "input");
  EXPECT_THAT(joiner_.Do(Chain(input_)), IsEmpty()) << "written again";
  Write(folder_ / "elsewhere/input", "input");
  EXPECT_THAT(joiner_.Do(Chain(folder_ / "elsewhere/input")), IsEmpty());
  fs::rename(output_, folder_ / "renamed");
  Joiner renamed(folder_ / "renamed");
  EXPECT_THAT(renamed.Do(Chain(input_)), IsEmpty());
}

TEST_F(StepChainTest, FieldsWithoutEffectDoNotCount) {
  fs::create_directories(output_);
  std::vector<Step> steps = Chain(input_);
  joiner_.Do(steps);
  steps[0].command.fields.emplace_back("threads", StepValue::Text("2"));
  steps[0].without_effect = {"threads"};
  EXPECT_THAT(joiner_.Do(steps), IsEmpty());
}

TEST_F(StepChainTest, MakesAnewWhatWasRemovedOrChanged) {
  fs::create_directories(output_);
  joiner_.Do(Chain(input_));
  fs::remove(output_ / "first.txt");
  EXPECT_THAT(joiner_.Do(Chain(input_)), ElementsAre("first"));
  Write(output_ / "first.txt", "cut o");
  EXPECT_THAT(joiner_.Do(Chain(input_)), ElementsAre("first"));
  fs::remove(output_ / "second.txt");
  EXPECT_THAT(joiner_.Do(Chain(input_)), ElementsAre("second"));
}

TEST_F(StepChainTest, GoesOnWhereItWasKilled) {
  fs::create_directories(output_);
  std::vector<Step> steps = Chain(input_);
  steps[1].resumes_by_field = true;
  joiner_.error = Error(ErrorKind::kBadInput, "disk full");
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { joiner_.Do(steps); }),
              AllOf(HasSubstr("disk full"), HasSubstr("in the step first")));
  EXPECT_THAT(joiner_.Do({steps[0]}), ElementsAre("first"));
  joiner_.error = Error(ErrorKind::kStopped, "stopped");
  ErrorOf(ErrorKind::kStopped, [&] { joiner_.Do(steps); });
  EXPECT_THAT(joiner_.Do(steps), ElementsAre("second resume"));
  EXPECT_THAT(joiner_.Do(Chain(input_)), IsEmpty());
}

TEST_F(StepChainTest, DoesNotContinueWhatWasBegunWithOtherOptions) {
  fs::create_directories(output_);
  std::vector<Step> steps = Chain(input_);
  steps[1].resumes_by_field = true;
  joiner_.Do({steps[0]});
  joiner_.error = Error(ErrorKind::kStopped, "stopped");
  ErrorOf(ErrorKind::kStopped, [&] { joiner_.Do(steps); });
  steps[1].command.fields.back().second.text = "3";
  EXPECT_THAT(joiner_.Do(steps), ElementsAre("second overwrite"));
}

TEST_F(StepChainTest, FindsOutputsByPatternAndRemovesThoseOfBefore) {
  fs::create_directories(output_);
  Write(output_ / "mine.csv", "the user's");
  std::vector<Step> steps = Chain(input_);
  steps[1].outputs = {"second.txt", "poses*.csv"};
  joiner_.also_write = {"poses_b.csv", "poses_a.csv"};
  joiner_.Do(steps);
  EXPECT_THAT(joiner_.outputs_of_last_, ElementsAre("poses_a.csv", "poses_b.csv", "second.txt"));
  fs::remove(output_ / "poses_a.csv");
  fs::remove(output_ / "poses_b.csv");
  joiner_.also_write = {"poses.csv"};
  EXPECT_THAT(joiner_.Do(steps), ElementsAre("second"));
  EXPECT_THAT(joiner_.outputs_of_last_, ElementsAre("poses.csv", "second.txt"));
  joiner_.also_write.clear();
  steps[1].outputs = {"second.txt"};
  steps[1].command.fields.back().second.text = "3";
  joiner_.Do(steps);
  EXPECT_FALSE(fs::exists(output_ / "poses.csv")) << "of a result that is no more";
  EXPECT_TRUE(fs::exists(output_ / "mine.csv"));
}

TEST_F(StepChainTest, RemovesPartsThatFollowFromSomethingElse) {
  fs::create_directories(output_);
  std::vector<Step> steps = Chain(input_);
  steps[0].parts = {{"parts/a", "video 1"}, {"parts/b", "video 2"}};
  joiner_.also_write = {"parts/a/0", "parts/b/0"};
  joiner_.Do(steps);
  joiner_.also_write.clear();
  steps[0].parts = {{"parts/a", "video 1"}, {"parts/b", "video 3"}};
  EXPECT_THAT(joiner_.Do(steps), ElementsAre("first"));
  EXPECT_TRUE(fs::exists(output_ / "parts/a/0"));
  EXPECT_FALSE(fs::exists(output_ / "parts/b"));
  steps[0].parts = {{"parts/b", "video 3"}};
  joiner_.Do(steps);
  EXPECT_FALSE(fs::exists(output_ / "parts/a"));
}

TEST_F(StepChainTest, WritesTheCommandsOfAllSteps) {
  fs::create_directories(output_);
  joiner_.Do(Chain(input_));
  const auto lines = [&] {
    return fmt::format("\nfirst {} output=first.txt mark=1\nsecond first.txt output=second.txt mark=2\n",
                       input_.string());
  };
  EXPECT_THAT(ReadFile(output_ / "commands.sh"), HasSubstr(lines()));
  joiner_.Do(Chain(input_));
  EXPECT_THAT(ReadFile(output_ / "commands.sh"), HasSubstr(lines())) << "also of those left alone";
}

TEST(StepRecords, AreWhatTheyWere) {
  const TemporaryFolder folder;
  EXPECT_TRUE(ReadStepRecords(folder.path()).steps.empty());
  StepRecords records{"walk", {{"solve", {"12ab", true, {{"solved.h5", "34cd"}}, {{"a/b", "c"}}}}}};
  WriteStepRecords(folder.path(), records);
  const StepRecords read = ReadStepRecords(folder.path());
  EXPECT_EQ(read.name, "walk");
  ASSERT_TRUE(read.steps.contains("solve"));
  const StepRecord& step = read.steps.at("solve");
  EXPECT_EQ(step.key, "12ab");
  EXPECT_TRUE(step.is_done);
  EXPECT_EQ(step.outputs, records.steps["solve"].outputs);
  EXPECT_EQ(step.parts, records.steps["solve"].parts);
}

TEST(StepRecords, OthersAreRefused) {
  const TemporaryFolder folder;
  const auto refusal = [&](const std::string& text) {
    Write(folder / "run.json", text);
    return ErrorOf(ErrorKind::kBadInput, [&] { ReadStepRecords(folder.path()); });
  };
  EXPECT_THAT(refusal("{\"format\": "), HasSubstr("damaged JSON"));
  EXPECT_THAT(refusal("{}"), HasSubstr("run.json"));
  EXPECT_THAT(refusal(R"({"format": "other", "version": 1})"), HasSubstr("something else"));
  EXPECT_THAT(refusal(R"({"format": "canonpose-run", "version": 2})"), HasSubstr("another version"));
  // What a step wrote may be removed.
  EXPECT_THAT(refusal(R"({"format": "canonpose-run", "version": 1, "name": "x", "steps": {"solve": {"key": "",
                          "is_done": true, "outputs": {"a/../../b": ""}, "parts": {}}}})"),
              HasSubstr("outside of the folder"));
}

}  // namespace
}  // namespace canonpose
