// Ctrl-C and SIGTERM ask `run`, `detect`, `train`, `train-morph` and `simulate` to stop at the next safe point; these
// then exit with 128 + the signal's number. Other commands leave signals to the system, which ends them at once.
#pragma once

#include <array>
#include <csignal>

#include "canonpose/base/callbacks.h"

namespace canonpose {

/// While it lives, the first SIGINT or SIGTERM asks the work of this thread to stop (Callbacks::stop); a second one
/// ends the program as usual. The previous handlers return afterwards. One may live within another: a signal that one
/// received asks the work of the other to stop, too.
class StopOnSignal {
 public:
  StopOnSignal();
  ~StopOnSignal();
  StopOnSignal(const StopOnSignal&) = delete;
  StopOnSignal& operator=(const StopOnSignal&) = delete;

  /// 128 + the signal that the last of these objects received, as in shells: 130 after SIGINT, 143 after SIGTERM. 128
  /// if there was none.
  [[nodiscard]] static int exit_code();

 private:
  CallbackScope scope_;
  std::array<struct sigaction, 2> previous_actions_{};
};

}  // namespace canonpose
