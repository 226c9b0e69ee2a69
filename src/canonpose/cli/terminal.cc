#include "canonpose/cli/terminal.h"

#include <cstdio>
#include <utility>

#include <fmt/format.h>
#include <unistd.h>

#include "canonpose/base/progress.h"

namespace canonpose {
namespace {

constexpr const char* kClearLine = "\r\033[K";

/// "12.5/s", or "37 s each" where that would be 0.0/s.
std::string DescribeSpeed(double per_second) {
  if (per_second >= 0.1) return fmt::format("{:.1f}/s", per_second);
  return FormatDuration(1.0 / per_second) + " each";
}

/// "LABEL done/total  DETAIL  speed  time left"
std::string Describe(const ProgressState& state) {
  std::string line = fmt::format("{} {}/{}", state.label, state.done, state.total);
  if (!state.detail.empty()) line += "  " + state.detail;
  if (state.per_second > 0) {
    line += fmt::format("  {}  {} left", DescribeSpeed(state.per_second), FormatDuration(state.seconds_left));
  }
  return line;
}

}  // namespace

Terminal::Terminal(std::function<std::string(const std::string&)> spell, Clock::duration lasting_period)
    : spell_(std::move(spell)), lasting_period_(lasting_period), is_terminal_(isatty(STDERR_FILENO) == 1) {}

Callbacks Terminal::MakeCallbacks() {
  Callbacks callbacks;
  callbacks.message = [this](MessageLevel level, const std::string& text) {
    Print((level == MessageLevel::kWarning ? "warning: " : "") + (spell_ ? spell_(text) : text));
  };
  callbacks.progress = [this](const ProgressState& state) { Show(state); };
  return callbacks;
}

void Terminal::Print(const std::string& line) const {
  fmt::print(stderr, "{}{}\n", is_terminal_ ? kClearLine : "", line);
  std::fflush(stderr);
}

void Terminal::Show(const ProgressState& state) {
  const Clock::time_point now = Clock::now();
  if (state.has_ended) {
    label_.clear();
    if (is_terminal_) fmt::print(stderr, "{}", kClearLine);
    return;
  }
  if (state.label != label_) {
    label_ = state.label;
    next_lasting_ = now + lasting_period_;
  }
  if (now >= next_lasting_) {
    next_lasting_ = now + lasting_period_;
    Print(Describe(state));
  } else if (is_terminal_) {
    // A line is cut at the width of the terminal: if it wrapped, its beginning could not be cleared.
    fmt::print(stderr, "{}\033[?7l{}\033[?7h", kClearLine, Describe(state));
    std::fflush(stderr);
  }
}

}  // namespace canonpose
