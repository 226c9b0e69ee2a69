#include "canonpose/train/restarts.h"

#include <algorithm>

#include "canonpose/base/error.h"
#include "canonpose/base/random.h"
#include "canonpose/train/streams.h"

namespace canonpose {

std::uint64_t RestartSeed(std::uint64_t seed, int restart) {
  if (restart == 0) return seed;
  return Rng(seed, {stream::kRestartSeeds, static_cast<std::uint64_t>(restart)}).Bits();
}

int BestRestart(const std::vector<double>& losses) {
  CANONPOSE_CHECK(!losses.empty());
  return static_cast<int>(std::min_element(losses.begin(), losses.end()) - losses.begin());
}

RestartPlan::RestartPlan(int count, std::int64_t steps, std::int64_t run_steps)
    : count_(count), steps_(std::min(steps, run_steps)), run_steps_(run_steps) {}

bool RestartPlan::IsRunning(const RestartState& state) const {
  return count_ > 1 && static_cast<std::int64_t>(state.losses.size()) < count_;
}

std::int64_t RestartPlan::StepsDone(const RestartState& state, std::int64_t step) const {
  return step + steps_ * (IsRunning(state) ? state.running : count_ - 1);
}

}  // namespace canonpose
