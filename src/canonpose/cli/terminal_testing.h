// Shared by tests only: what a program says on a terminal and in a pipe.
#pragma once

#include <algorithm>
#include <cstdio>
#include <string>
#include <utility>

#include <gtest/gtest.h>
#include <pty.h>
#include <sys/wait.h>
#include <unistd.h>

#include "canonpose/base/error.h"

namespace canonpose::testing {

enum class Output { kTerminal, kPipe };

/// Everything that `action`, in a process of its own, writes to stdout and stderr, both of which are `output`. The
/// process must end with `exit_code`.
template <typename Action>
std::string SaidTo(Output output, Action&& action, int exit_code = 0) {
  int end = -1;
  pid_t child = -1;
  if (output == Output::kTerminal) {
    child = forkpty(&end, nullptr, nullptr, nullptr);
  } else {
    int ends[2];
    CANONPOSE_CHECK(pipe(ends) == 0, "no pipe");
    end = ends[0];
    child = fork();
    if (child == 0) {
      dup2(ends[1], STDOUT_FILENO);
      dup2(ends[1], STDERR_FILENO);
    }
    close(ends[1]);
  }
  CANONPOSE_CHECK(child >= 0, "no process");
  if (child == 0) {
    std::forward<Action>(action)();
    std::fflush(nullptr);
    _exit(0);
  }
  std::string said;
  char buffer[4096];
  for (ssize_t count = 0; (count = read(end, buffer, sizeof buffer)) > 0;) {
    said.append(buffer, static_cast<std::size_t>(count));
  }
  close(end);
  int status = -1;
  waitpid(child, &status, 0);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == exit_code) << status << said;
  return said;
}

/// What remains on the terminal: each line from where it was cleared last.
inline std::string Lasting(const std::string& said) {
  const std::string clear = "\r\033[K";
  std::string lasting;
  for (std::size_t begin = 0; begin < said.size();) {
    const std::size_t end = std::min(said.find('\n', begin), said.size());
    std::string line = said.substr(begin, end - begin);
    if (const std::size_t last = line.rfind(clear); last != std::string::npos) line.erase(0, last + clear.size());
    if (line.ends_with('\r')) line.pop_back();  // a terminal's line ends with \r\n
    if (end < said.size()) line += '\n';
    lasting += line;
    begin = end + 1;
  }
  return lasting;
}

}  // namespace canonpose::testing
