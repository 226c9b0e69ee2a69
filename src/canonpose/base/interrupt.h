// Ctrl-C and SIGTERM as a request that long work answers at its next safe point.
#pragma once

namespace canonpose {

/// While it lives, the first SIGINT or SIGTERM only sets a flag; a second one ends the program as usual. What was set
/// for these signals before is set again afterwards.
class InterruptGuard {
 public:
  InterruptGuard();
  ~InterruptGuard();
  InterruptGuard(const InterruptGuard&) = delete;
  InterruptGuard& operator=(const InterruptGuard&) = delete;

  /// The signal received, 0 while there was none.
  [[nodiscard]] int signal() const;
};

}  // namespace canonpose
