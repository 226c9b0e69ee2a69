#include "canonpose/base/child_process.h"

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "canonpose/base/bytes.h"
#include "canonpose/base/testing.h"

namespace canonpose {
namespace {

std::string Repeat(std::string_view question) { return std::string(question) + std::string(question); }

TEST(ChildProcess, AnswersAndKeepsItsMemoryToItself) {
  int count = 0;
  ChildProcess child(
      [&](std::string_view question) {
        ++count;
        return Repeat(question) + std::to_string(count);
      },
      {});
  EXPECT_EQ(child.Ask("a"), "aa1");
  EXPECT_EQ(child.Ask(""), "2");
  std::string large;
  large.resize(10'000'000, 'x');
  EXPECT_EQ(child.Ask(large), large + large + "3");
  EXPECT_EQ(count, 0);
}

TEST(ChildProcess, ErrorsArriveAndTheChildGoesOn) {
  ChildProcess child(
      [](std::string_view question) {
        if (question == "bad") throw Error(ErrorKind::kComputation, "it diverged");
        return Repeat(question);
      },
      {});
  EXPECT_EQ(testing::ErrorOf(ErrorKind::kComputation, [&] { (void)child.Ask("bad"); }), "it diverged");
  EXPECT_EQ(child.Ask("a"), "aa");
}

TEST(ChildProcess, ACrashIsNoticedAndSilent) {
  ::testing::internal::CaptureStderr();
  const std::vector<void (*)()> ends = {[] { std::abort(); }, [] { (void)std::raise(SIGSEGV); }, [] { std::_Exit(0); },
                                        [] { throw 1; }};
  for (const auto& end : ends) {
    ChildProcess child(
        [&](std::string_view question) {
          std::fputs("printed\n", stderr);
          if (question == "end") end();
          return Repeat(question);
        },
        {});
    EXPECT_EQ(child.Ask("a"), "aa");
    EXPECT_FALSE(child.Ask("end").has_value());
    EXPECT_EQ(child.why_ended(), "crashes");
    EXPECT_FALSE(child.Ask("a").has_value()) << "nobody is left to answer";
  }
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
}

TEST(ChildProcess, SignalsOfTheTerminalAreNotForIt) {
  ChildProcess child(
      [](std::string_view question) {
        for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT}) (void)std::raise(signal);
        return Repeat(question);
      },
      {});
  EXPECT_EQ(child.Ask("a"), "aa");
}

TEST(ChildProcess, EndlessWorkIsEnded) {
  ChildProcess::Limits limits;
  limits.cpu_seconds = 1.0;
  ChildProcess child(
      [](std::string_view question) {
        const volatile bool is_endless = true;
        while (is_endless) {
        }
        return Repeat(question);
      },
      limits);
  EXPECT_FALSE(child.Ask("a").has_value());
  EXPECT_EQ(child.why_ended(), "does not come to an end");
}

TEST(ChildProcess, MemoryIsLimited) {
  ChildProcess::Limits limits;
  limits.memory_bytes = std::size_t{64} << 20;
  ChildProcess child([](std::string_view question) { return std::string(std::stoul(std::string(question)), 'x'); },
                     limits);
  EXPECT_EQ(child.Ask("3"), "xxx");
  EXPECT_FALSE(child.Ask(std::to_string(std::size_t{256} << 20)).has_value());
#ifndef __SANITIZE_ADDRESS__  // which ends the process where memory is refused
  EXPECT_EQ(child.why_ended(), "takes too much memory");
#endif
}

TEST(ChildProcess, SeveralThreadsHaveTheirOwn) {
  std::vector<int> answered(4, 0);
  std::vector<std::thread> threads;
  for (int& own : answered) {
    threads.emplace_back([&own] {
      for (int i = 0; i < 5; ++i) {
        ChildProcess child(Repeat, {});
        own += child.Ask("a") == "aa" && child.Ask("b") == "bb" ? 1 : 0;
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(answered, std::vector<int>(4, 5));
}

TEST(ChildProcess, ChildrenThatTheSystemForgetsDoNoHarm) {
  const auto before = std::signal(SIGCHLD, SIG_IGN);
  {
    ChildProcess child(Repeat, {});
    EXPECT_EQ(child.Ask("a"), "aa");
  }
  (void)std::signal(SIGCHLD, before);
}

TEST(Bytes, WhatIsWrittenIsRead) {
  ByteWriter writer;
  writer.Number(2.5);
  writer.Text("text");
  writer.Numbers(std::vector<float>{1.0F, 2.0F});
  writer.Texts({"", "b"});
  const std::string bytes = writer.Take();
  ByteReader reader(bytes);
  EXPECT_EQ(reader.Number<double>(), 2.5);
  EXPECT_EQ(reader.Text(), "text");
  EXPECT_EQ(reader.Numbers<float>(), (std::vector<float>{1.0F, 2.0F}));
  EXPECT_EQ(reader.Texts(), (std::vector<std::string>{"", "b"}));
  EXPECT_TRUE(reader.ok() && reader.at_end());
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    ByteReader cut(std::string_view(bytes).substr(0, size));
    (void)cut.Number<double>();
    (void)cut.Text();
    (void)cut.Numbers<float>();
    (void)cut.Texts();
    EXPECT_FALSE(cut.ok()) << size;
  }
  const std::string endless(16, '\xff');
  ByteReader reader_of_endless(endless);
  EXPECT_TRUE(reader_of_endless.Numbers<double>().empty());
  EXPECT_FALSE(reader_of_endless.ok());
}

}  // namespace
}  // namespace canonpose
