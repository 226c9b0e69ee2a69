// Shared by tests only: runs the program and returns what it printed and how it ended.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "canonpose/base/atomic_file.h"
#include "canonpose/base/testing.h"

namespace canonpose::testing {

struct Outcome {
  int exit_code = -1;  ///< 128 + signal where it was killed
  std::string output;
  std::string errors;  ///< stderr
  /// The last line of stderr: the message of a failure.
  [[nodiscard]] std::string message() const {
    const std::size_t end = errors.find_last_not_of('\n');
    if (end == std::string::npos) return "";
    const std::size_t begin = errors.rfind('\n', end);
    return errors.substr(begin == std::string::npos ? 0 : begin + 1,
                         end - (begin == std::string::npos ? 0 : begin + 1) + 1);
  }
};

/// Where the program looks for the detector.
inline std::filesystem::path ModelFolder() {
  if (const char* const models = std::getenv("CANONPOSE_MODELS")) return models;
  const char* const data = std::getenv("XDG_DATA_HOME");
  const char* const home = std::getenv("HOME");
  if (data != nullptr) return std::filesystem::path(data) / "canonpose/movenet";
  return home == nullptr ? std::filesystem::path() : std::filesystem::path(home) / ".local/share/canonpose/movenet";
}

/// Turns this process into the program.
[[noreturn]] inline void Become(const std::vector<std::string>& arguments) {
  std::vector<char*> pointers;
  std::string program = CANONPOSE_PROGRAM;
  pointers.push_back(program.data());
  std::vector<std::string> copies = arguments;
  for (std::string& argument : copies) pointers.push_back(argument.data());
  pointers.push_back(nullptr);
  execv(program.c_str(), pointers.data());
  _exit(127);
}

inline pid_t Start(const std::vector<std::string>& arguments, const std::filesystem::path& output,
                   const std::filesystem::path& errors) {
  const pid_t child = fork();
  if (child != 0) return child;
  const int out = open(output.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0666);
  const int err = open(errors.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0666);
  dup2(out, STDOUT_FILENO);
  dup2(err, STDERR_FILENO);
  Become(arguments);
}

inline int Wait(pid_t child) {
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

inline Outcome Execute(const std::vector<std::string>& arguments) {
  const TemporaryFolder folder;
  const pid_t child = Start(arguments, folder / "out", folder / "err");
  Outcome outcome;
  outcome.exit_code = Wait(child);
  outcome.output = ReadFile(folder / "out");
  outcome.errors = ReadFile(folder / "err");
  return outcome;
}

/// Whether training came to its end and wrote its model. The poses of a network that was trained so briefly cannot be
/// believed, and the program says so by exit code 4.
inline bool HasTrained(const Outcome& outcome) {
  return outcome.exit_code == 0 ||
         (outcome.exit_code == 4 &&
          outcome.message().find("is written, but its 3D poses cannot be believed: ") != std::string::npos);
}

/// Exit code 3 and one line of the form "error: FILE: ...".
inline void ExpectBadInput(const std::vector<std::string>& arguments, const ::testing::Matcher<std::string>& matcher) {
  const Outcome outcome = Execute(arguments);
  EXPECT_EQ(outcome.exit_code, 3) << outcome.errors;
  EXPECT_THAT(outcome.message(), ::testing::AllOf(::testing::StartsWith("error: "), matcher));
}

}  // namespace canonpose::testing
