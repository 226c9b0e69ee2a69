// Ctrl-C and SIGTERM ask long work to stop at its next safe point.
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

  /// 128 + the signal received, as in shells; 128 if there was none.
  [[nodiscard]] int exit_code() const;

 private:
  CallbackScope scope_;
};

}  // namespace canonpose
