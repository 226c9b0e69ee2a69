// How far long work is: a lasting line now and then, the same on a terminal as anywhere else, so that what was said is
// the same. On a terminal a line in place keeps moving in between.
#pragma once

#include <chrono>
#include <string>

namespace canonpose {

/// "1 h 02 min", "3 min 05 s", "12 s".
std::string FormatDuration(double seconds);

class Progress {
 public:
  using Clock = std::chrono::steady_clock;
  static constexpr std::chrono::seconds kLastingPeriod{10};

  /// `total` steps are to come, `done` of which lie behind already (a resumed run), so that the speed is this run's
  /// own. A lasting line comes every `lasting_period`.
  Progress(std::string label, long total, long done = 0, Clock::duration lasting_period = kLastingPeriod);
  /// Clears the line in place.
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// Shows "LABEL  done/total  DETAIL  speed  time left" if it is time to; cheap enough to be called every step.
  void Update(long done, const std::string& detail);
  /// Whether the next Update() will show something, so that a costly `detail` need not be made otherwise.
  [[nodiscard]] bool IsDue() const;

 private:
  [[nodiscard]] std::string Describe(long done, const std::string& detail, Clock::time_point now) const;

  std::string label_;
  long total_;
  long first_;
  bool is_terminal_;
  Clock::duration lasting_period_;
  Clock::time_point start_ = Clock::now();
  Clock::time_point next_lasting_;
  Clock::time_point next_in_place_;  ///< never, where there is no terminal
};

}  // namespace canonpose
