// Several short runs from different seeds, of which the best is continued: view consistency alone may settle in the
// trap (train/trap.h), and its loss shows that before the end, though not at once.
#pragma once

#include <cstdint>
#include <vector>

#include "canonpose/train/checkpoint.h"

namespace canonpose {

/// The seed of a short run; the first has the whole run's own. The run that is continued is, bit for bit, what a run
/// from its seed without restarts would be.
std::uint64_t RestartSeed(std::uint64_t seed, int restart);

/// The number of the smallest loss, the first among equals. There is at least one.
int BestRestart(const std::vector<double>& losses);

/// How many short runs there are and how long they take.
class RestartPlan {
 public:
  /// `count` runs of `steps`, one of which becomes the beginning of a run of `run_steps`.
  RestartPlan(int count, std::int64_t steps, std::int64_t run_steps);
  /// Steps of a short run; no more than those of the whole run.
  [[nodiscard]] std::int64_t steps() const { return steps_; }
  /// Whether one of them is under way; a single one is not a restart.
  [[nodiscard]] bool IsRunning(const RestartState& state) const;
  /// Steps of the whole run and of the short ones that are not continued.
  [[nodiscard]] std::int64_t StepsInAll() const { return run_steps_ + (count_ - 1) * steps_; }
  /// How many of these are done after `step` steps of the run that is under way.
  [[nodiscard]] std::int64_t StepsDone(const RestartState& state, std::int64_t step) const;

 private:
  std::int64_t count_;
  std::int64_t steps_;
  std::int64_t run_steps_;
};

}  // namespace canonpose
