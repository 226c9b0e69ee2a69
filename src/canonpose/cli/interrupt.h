// Ctrl-C and SIGTERM ask `detect`, `train`, `train-morph` and `simulate` to stop at the next safe point; these then
// exit with 128
// + the signal's number. Other commands leave signals to the system, which ends them at once.
#pragma once

#include "canonpose/base/callbacks.h"

namespace canonpose {

/// While it lives, the first SIGINT or SIGTERM asks the work of this thread to stop (Callbacks::stop); a second one
/// ends the program as usual. The previous handlers return afterwards.
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
};

}  // namespace canonpose
