#include "canonpose/base/callbacks.h"

#include <chrono>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/base/atomic_file.h"
#include "canonpose/base/log.h"
#include "canonpose/base/parallel.h"
#include "canonpose/base/progress.h"
#include "canonpose/base/testing.h"

namespace canonpose {
namespace {

using testing::CollectedMessages;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(Callbacks, WithoutAnyWorkIsSilentAndContinues) {
  ::testing::internal::CaptureStderr();
  ::testing::internal::CaptureStdout();
  LogWarning("nobody hears");
  {
    Progress progress("step", 2, 0, std::chrono::seconds(0));
    EXPECT_FALSE(progress.IsDue());
    progress.Update(1, "");
  }
  EXPECT_FALSE(StopRequested());
  EXPECT_EQ(::testing::internal::GetCapturedStderr() + ::testing::internal::GetCapturedStdout(), "");
}

TEST(Callbacks, InnerScopesHideOuterOnesUntilTheyEnd) {
  const CollectedMessages outer;
  {
    const CollectedMessages inner;
    LogInfo("in");
    EXPECT_EQ(inner.text(), "in\n");
  }
  LogWarning("out {}", 1);
  EXPECT_EQ(outer.text(), "warning: out 1\n");
}

TEST(Callbacks, HoldForTheThreadsOfParallelWork) {
  const CollectedMessages collected;
  InParallel(16, 4, [](int) { LogInfo("work"); });
  std::string expected;
  for (int i = 0; i < 16; ++i) expected += "work\n";
  EXPECT_EQ(collected.text(), expected);
}

TEST(Callbacks, PassOnReachesTheOuterScope) {
  std::vector<std::string> heard;
  bool stop = false;
  Callbacks outer;
  outer.message = [&](MessageLevel, const std::string& text) { heard.push_back(text); };
  outer.stop = [&] { return stop; };
  const CallbackScope outer_scope(outer);
  Callbacks inner = PassOn();
  EXPECT_FALSE(inner.progress) << "the outer scope has none to forward it to";
  const CallbackScope inner_scope(inner);
  LogInfo("through");
  EXPECT_THAT(heard, ElementsAre("through"));
  EXPECT_FALSE(StopRequested());
  stop = true;
  EXPECT_TRUE(StopRequested());
}

TEST(LogFile, TakesWhatTheCallerHearsAndMore) {
  const testing::TemporaryFolder folder;
  const CollectedMessages collected;
  {
    LogFile file(folder / "log");
    LogWarning("both");
    file.Write("file alone");
  }
  LogInfo("caller alone");
  EXPECT_EQ(collected.text(), "warning: both\ncaller alone\n");
  const std::string written = ReadFile(folder / "log");
  EXPECT_THAT(written, HasSubstr("warning: both\n"));
  EXPECT_THAT(written, HasSubstr("file alone\n"));
  EXPECT_EQ(written.find("caller alone"), std::string::npos);
}

TEST(Progress, SendsStatesAndThatTheWorkHasEnded) {
  std::vector<ProgressState> states;
  Callbacks callbacks;
  callbacks.progress = [&](const ProgressState& state) { states.push_back(state); };
  const CallbackScope scope(callbacks);
  {
    Progress progress("step", 10, 4, std::chrono::seconds(0));
    progress.Update(5, "loss 0.5");
    progress.Update(6, "loss 0.4");
  }
  ASSERT_EQ(states.size(), 3U);
  EXPECT_EQ(states[0].label, "step");
  EXPECT_EQ(states[0].done, 5);
  EXPECT_EQ(states[0].total, 10);
  EXPECT_EQ(states[1].detail, "loss 0.4");
  EXPECT_GT(states[1].per_second, 0.0);
  EXPECT_GT(states[1].seconds_left, 0.0);
  EXPECT_FALSE(states[1].has_ended);
  EXPECT_TRUE(states[2].has_ended);
}

TEST(Progress, DoesNotSendMoreThanAPersonCanRead) {
  int count = 0;
  Callbacks callbacks;
  callbacks.progress = [&](const ProgressState&) { ++count; };
  const CallbackScope scope(callbacks);
  Progress progress("step", 1000);
  for (long done = 1; done <= 1000; ++done) progress.Update(done, "");
  EXPECT_LE(count, 5);
}

}  // namespace
}  // namespace canonpose
