// The command line from the user's side: help, and the messages about mistakes.
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "canonpose/cli/program_testing.h"

namespace canonpose {
namespace {

using ::testing::AllOf;
using testing::Execute;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::Outcome;

/// Exit code 2 and exactly this line.
void ExpectMistake(const std::vector<std::string>& arguments, const ::testing::Matcher<std::string>& matcher) {
  const Outcome outcome = Execute(arguments);
  EXPECT_EQ(outcome.exit_code, 2) << outcome.errors;
  EXPECT_EQ(outcome.errors, outcome.message() + "\n");
  EXPECT_THAT(outcome.message(), matcher);
}

TEST(Usage, HelpAndVersionAreCommandsToo) {
  const Outcome help = Execute({"help"});
  EXPECT_EQ(help.exit_code, 0) << help.errors;
  EXPECT_EQ(help.output, Execute({"--help"}).output);
  const Outcome version = Execute({"version"});
  EXPECT_EQ(version.exit_code, 0) << version.errors;
  EXPECT_EQ(version.output, Execute({"--version"}).output);
  for (const std::string command :
       {"import", "simulate", "train", "train-morph", "evaluate", "solve", "lift", "export", "info"}) {
    EXPECT_THAT(help.output, HasSubstr(command));
    const Outcome of_command = Execute({"help", command});
    EXPECT_EQ(of_command.exit_code, 0) << command << of_command.errors;
    EXPECT_THAT(of_command.output, HasSubstr("canonpose " + command));
    EXPECT_EQ(of_command.output, Execute({command, "--help"}).output);
  }
  EXPECT_EQ(Execute({"help", "help"}).exit_code, 0);
}

// runtime_test asks the same of a test program; this is the one that users run.
TEST(Usage, TheProgramMultipliesMatricesAboutAsFastAsOpenBlasAlone) {
  const Outcome outcome = Execute({"version", "--json"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_EQ(outcome.errors, "");
  const nlohmann::json program = nlohmann::json::parse(outcome.output);
  EXPECT_THAT(Execute({"version"}).output, HasSubstr(program["version"].get<std::string>()));
  const nlohmann::json& algebra = program["linear_algebra"];
  if (algebra["library"] == "MKL") GTEST_SKIP() << "this LibTorch brings MKL";
  EXPECT_THAT(algebra["library"].get<std::string>(), HasSubstr("openblas"));
  EXPECT_GT(algebra["openblas_gflops"].get<double>(), 0.0);
  EXPECT_GT(algebra["gflops"].get<double>(), algebra["openblas_gflops"].get<double>() / 3.0);
}

TEST(Usage, AFrameRateOfZeroIsNotTakenForAnUnknownOne) {
  for (const std::string rate : {"0", "-5", "nan"}) {
    ExpectMistake({"import", "openpose", "any", "-o", "a.h5", "--fps", rate}, HasSubstr("--fps: expected frames per"));
  }
}

TEST(Usage, AnUnknownCommandIsNamedWithTheNearest) {
  ExpectMistake({"imprt"}, "error: there is no command \"imprt\"; did you mean import? (canonpose help lists them)");
  ExpectMistake({"evaluate-all"}, AllOf(HasSubstr("\"evaluate-all\""), HasSubstr("did you mean evaluate?")));
  ExpectMistake({"help", "trian"}, AllOf(HasSubstr("\"trian\""), HasSubstr("did you mean train?")));
  ExpectMistake(
      {"fly", "--high"},
      AllOf(HasSubstr("\"fly\""), HasSubstr("the commands are run, detect, import, simulate"), Not(HasSubstr("mean"))));
  ExpectMistake({}, AllOf(HasSubstr("a command is missing"), HasSubstr("info")));
}

TEST(Usage, AnUnknownOptionIsNamedWithTheNearest) {
  ExpectMistake({"train", "data.h5", "--ouput", "run"},
                "error: train has no option --ouput; did you mean --output? (see canonpose help train)");
  ExpectMistake({"info", "data.h5", "--jsn=1"},
                AllOf(HasSubstr("no option --jsn;"), HasSubstr("did you mean --json?")));
  ExpectMistake({"info", "data.h5", "--wholly-unlike"}, AllOf(HasSubstr("--wholly-unlike ("), Not(HasSubstr("mean"))));
  ExpectMistake({"--versoin"}, AllOf(HasSubstr("--versoin"), HasSubstr("did you mean --version?")));
  ExpectMistake({"info"}, AllOf(HasSubstr("file is required"), HasSubstr("canonpose help info")));
}

TEST(Usage, ADecimalCommaIsAnsweredByThePoint) {
  ExpectMistake({"lift", "run", "data.h5", "-o", "x.npz", "--height", "1,75"},
                AllOf(HasSubstr("--height"), HasSubstr("write 1.75, with a point")));
  ExpectMistake({"simulate", "-o", "x.h5", "--seconds", "2,5"}, HasSubstr("write 2.5, with a point"));
  ExpectMistake({"train", "data.h5", "-o", "run", "--set", "learning_rate=0,001"},
                AllOf(HasSubstr("learning_rate"), HasSubstr("write 0.001, with a point")));
  ExpectMistake({"train", "data.h5", "-o", "run", "--epochs", "0"},
                AllOf(HasSubstr("--epochs"), HasSubstr("1 or more")));
}

TEST(Usage, OnlyCommandsThatInvolveChanceHaveASeed) {
  for (const std::string command : {"simulate", "solve", "train", "train-morph"}) {
    EXPECT_THAT(Execute({command, "--help"}).output, HasSubstr("--seed")) << command;
  }
  for (const std::string command : {"evaluate", "export", "import", "info", "lift"}) {
    EXPECT_THAT(Execute({command, "--help"}).output, Not(HasSubstr("--seed"))) << command;
    ExpectMistake({command, "--seed", "1"}, HasSubstr(command + " has no option --seed"));
  }
}

}  // namespace
}  // namespace canonpose
