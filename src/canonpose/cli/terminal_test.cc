#include "canonpose/cli/terminal.h"

#include <chrono>
#include <regex>
#include <string>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/base/log.h"
#include "canonpose/base/progress.h"
#include "canonpose/cli/terminal_testing.h"

namespace canonpose {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using testing::Lasting;
using ::testing::Not;
using testing::Output;
using testing::SaidTo;

TEST(Terminal, LeavesTheSameLinesOnATerminalAndInAPipe) {
  const auto work = [] {
    Terminal terminal({}, std::chrono::seconds(0));  // every line lasts
    const CallbackScope callbacks(terminal.MakeCallbacks());
    LogInfo("begin");
    {
      Progress progress("step", 3, 0, std::chrono::seconds(0));
      for (long done = 1; done <= 3; ++done) progress.Update(done, "loss 0.5");
    }
    LogWarning("end");
  };
  // Speeds differ.
  const auto masked = [](const std::string& said) {
    return std::regex_replace(Lasting(said), std::regex(R"(  [0-9.]+/s  .* left)"), "  SPEED");
  };
  EXPECT_EQ(masked(SaidTo(Output::kPipe, work)),
            "begin\nstep 1/3  loss 0.5  SPEED\nstep 2/3  loss 0.5  SPEED\nstep 3/3  loss 0.5  SPEED\nwarning: end\n");
  EXPECT_EQ(masked(SaidTo(Output::kTerminal, work)), masked(SaidTo(Output::kPipe, work)));
}

TEST(Terminal, UpdatesALineInPlaceOnlyOnATerminal) {
  const auto work = [] {
    Terminal terminal;
    const CallbackScope callbacks(terminal.MakeCallbacks());
    Progress progress("step", 3);
    progress.Update(1, "soon");
    std::this_thread::sleep_for(std::chrono::milliseconds(250));
    progress.Update(2, "later");
  };
  EXPECT_EQ(SaidTo(Output::kPipe, work), "");
  const std::string said = SaidTo(Output::kTerminal, work);
  EXPECT_THAT(said, AllOf(HasSubstr("step 2/3  later"), Not(HasSubstr("soon")), Not(HasSubstr("\n"))));
  EXPECT_EQ(Lasting(said), "");
}

TEST(Terminal, SlowWorkIsGivenInSecondsForEachStep) {
  const auto work = [] {
    Terminal terminal({}, std::chrono::seconds(0));
    Callbacks callbacks = terminal.MakeCallbacks();
    callbacks.progress({"solve", 1, 4, "camera cam04", 1.0 / 37.0, 111.0, false});
    callbacks.progress({"solve", 2, 4, "", 12.34, 1.0, false});
  };
  EXPECT_EQ(SaidTo(Output::kPipe, work),
            "solve 1/4  camera cam04  37 s each  1 min 51 s left\nsolve 2/4  12.3/s  1 s left\n");
}

TEST(Terminal, SpellsMessages) {
  const auto work = [] {
    Terminal terminal([](const std::string& text) { return "<" + text + ">"; });
    const CallbackScope callbacks(terminal.MakeCallbacks());
    LogWarning("low light");
  };
  EXPECT_EQ(SaidTo(Output::kPipe, work), "warning: <low light>\n");
}

}  // namespace
}  // namespace canonpose
