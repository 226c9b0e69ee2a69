// How far long-running work has come, reported to the caller (callbacks.h) as often as a person can read it.
#pragma once

#include <chrono>
#include <string>

#include "canonpose/base/callbacks.h"

namespace canonpose {

/// "1 h 02 min", "3 min 05 s", "12 s".
std::string FormatDuration(double seconds);

class Progress {
 public:
  using Clock = std::chrono::steady_clock;
  static constexpr std::chrono::milliseconds kPeriod{200};

  /// There are `total` steps, of which `done` were done before (by a run that is resumed) and do not count for the
  /// speed.
  Progress(std::string label, long total, long done = 0, Clock::duration period = kPeriod);
  /// Reports that the work has ended.
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// Reports the state if enough time has passed; cheap enough to be called at every step.
  void Update(long done, const std::string& detail);
  /// Whether the next Update() will report anything, so that an expensive `detail` need not be made otherwise.
  [[nodiscard]] bool IsDue() const;

 private:
  ProgressState state_;
  long first_;
  Clock::duration period_;
  Clock::time_point start_ = Clock::now();
  Clock::time_point next_;
  bool has_sent_ = false;
};

}  // namespace canonpose
