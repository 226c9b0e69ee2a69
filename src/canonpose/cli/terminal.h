// What the commands show on stderr: messages as lines, progress as a line in place where there is a terminal, and every
// ten seconds as a line that stays, so that a log holds the same as a terminal.
#pragma once

#include <chrono>
#include <functional>
#include <string>

#include "canonpose/base/callbacks.h"

namespace canonpose {

class Terminal {
 public:
  using Clock = std::chrono::steady_clock;

  /// `spell` is applied to messages (option_names.h). A progress line stays every `lasting_period`.
  explicit Terminal(std::function<std::string(const std::string&)> spell = {},
                    Clock::duration lasting_period = std::chrono::seconds(10));

  /// They refer to this object.
  Callbacks MakeCallbacks();

  /// One line on stderr; a line in place is cleared first.
  void Print(const std::string& line) const;

 private:
  void Show(const ProgressState& state);

  std::function<std::string(const std::string&)> spell_;
  Clock::duration lasting_period_;
  bool is_terminal_;
  std::string label_;  ///< of the work that was shown last
  Clock::time_point next_lasting_;
};

}  // namespace canonpose
