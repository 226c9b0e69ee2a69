// A progress line: in place on a terminal, as plain lines now and then elsewhere.
#pragma once

#include <chrono>
#include <string>

namespace canonpose {

/// "1 h 02 min", "3 min 05 s", "12 s".
std::string FormatDuration(double seconds);

class Progress {
 public:
  /// `total` steps are to come, `done` of which lie behind already (a resumed run), so that the speed is this run's
  /// own.
  Progress(std::string label, long total, long done = 0);
  /// Clears the line.
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// Shows "LABEL  done/total  DETAIL  speed  time left" if it is time to; cheap enough to be called every step.
  void Update(long done, const std::string& detail);
  /// Whether the next Update() will show something, so that a costly `detail` need not be made otherwise.
  [[nodiscard]] bool IsDue() const;

 private:
  using Clock = std::chrono::steady_clock;
  std::string label_;
  long total_;
  long first_;
  bool is_terminal_;
  Clock::time_point start_ = Clock::now();
  Clock::time_point next_show_;
};

}  // namespace canonpose
