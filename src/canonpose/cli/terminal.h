// What the commands show on stderr: messages as lines; progress as one line that is updated in place on a terminal, and
// as a line that stays every ten seconds, so that a log shows it, too.
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

  /// Prints one line to stderr; a progress line is cleared first.
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
