// How far long work has come, sent to the caller (callbacks.h) as often as a person can read it.
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

  /// `total` steps in all, of which `done` lie behind already (a resumed run): they do not count in the speed.
  Progress(std::string label, long total, long done = 0, Clock::duration period = kPeriod);
  /// Tells the caller that the work has ended.
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// Sends the state if it is time to; cheap enough to be called every step.
  void Update(long done, const std::string& detail);
  /// Whether the next Update() will send something, so that a costly `detail` need not be made otherwise.
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
