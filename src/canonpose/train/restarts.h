// Several short runs from different seeds, of which the best is gone on with: view mixing alone may settle in a trap,
// and its loss shows that before the end, though not at once.
#pragma once

#include <cstdint>
#include <vector>

#include "canonpose/train/checkpoint.h"

namespace canonpose {

/// The seed of a short run: for the first the whole run's own. What is gone on with is the run of its seed alone, bit
/// for bit.
std::uint64_t RestartSeed(std::uint64_t seed, int restart);

/// The number of the least loss, the first of equals; there is at least one.
int BestRestart(const std::vector<double>& losses);

/// How many short runs there are and how long they take.
class RestartPlan {
 public:
  /// `count` of `steps` each, before or as the beginning of a run of `run_steps`.
  RestartPlan(int count, std::int64_t steps, std::int64_t run_steps);
  /// Of one of them; no more than of the whole run.
  [[nodiscard]] std::int64_t steps() const { return steps_; }
  /// Whether one of them is under way; a single run is not compared with anything.
  [[nodiscard]] bool IsRunning(const RestartState& state) const;
  /// Steps of the whole run and of those that were not chosen.
  [[nodiscard]] std::int64_t StepsInAll() const { return run_steps_ + (count_ - 1) * steps_; }
  /// How many of them are done after `step` steps of what is under way.
  [[nodiscard]] std::int64_t StepsDone(const RestartState& state, std::int64_t step) const;

 private:
  std::int64_t count_;
  std::int64_t steps_;
  std::int64_t run_steps_;
};

}  // namespace canonpose
